/// Parameter planes of a report: metrics and regimes, thresholds and folds. Include only in .cpp files.
#pragma once
#include "app/report/figures.hpp"

namespace rosin::app::report {

/// A number with so many significant digits, null where it is none: pages are half as long as with all digits.
ordered_json rounded(double value, int digits);

/// Planes of a document that has any: maps, basins, comparisons over a plane, designs.
void add_planes(const Folder&, const Result&, std::vector<Figure>&);

}  // namespace rosin::app::report
