/// What figures of a scene's results have in common: title, caption, and axes named as the glossary has it.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/results/figure.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// A figure with the scene's title, and what it is made of below.
/// \param varied parameters that it is drawn over, left out below
results::Figure figure_of(const scene::Scene&, std::string name, std::string what,
                          const std::vector<std::string>& varied = {});

/// The axis of a column: "slip rate v", with the prefix of its unit that suits the values.
results::Axis axis_of(const std::string& column, const std::string& unit, results::Extent shown = {});
/// The axis of a number of a scene, with its symbol: "speed of the driving surface V", "force on the slider f,
/// amplitude of harmonic 1".
results::Axis axis_of(std::string_view path, const Quantity&, bool decades = false);

/// A table of such columns.
results::FigureTable::Column column_of(const std::string& name, const std::string& unit, std::vector<double> values);

}  // namespace rosin::app::output
