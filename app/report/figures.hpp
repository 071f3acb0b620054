/// Figures of a report: planes of documents, and what results declare. Include only in .cpp files.
#pragma once
#include <string>
#include <vector>

#include "app/report/folder.hpp"

namespace rosin::app::report {

struct Figure {
  std::string caption;
  ordered_json data;         ///< as page.js draws it: "kind" is "curves" or "plane"
  std::string picture = {};  ///< in place of data: the file of what gnuplot drew, if it did
};

/// Those of one verb's results; others of the folder may show points of a plane in more detail.
std::vector<Figure> figures_of(const Folder&, const Result&);

/// The command that made a result, for a shell; without its --set of the given parameters.
std::string command_of(const Result&, const std::string& verb, const std::vector<std::string>& varied = {});

}  // namespace rosin::app::report
