/// Figures of a report, found in documents by their shape: series over time, planes, responses, branches, … Include
/// only in .cpp files.
#pragma once
#include <string>
#include <vector>

#include "app/report/folder.hpp"

namespace rosin::app::report {

struct Figure {
  std::string caption;
  ordered_json data;  ///< as page.js draws it: "kind" is "curves" or "plane"
  /// Further views of the same numbers: one column over another.
  struct View {
    std::string title;
    std::size_t x, y;
  };
  std::vector<View> views = {};
};

/// Those of one verb's results; others of the folder may show points of a plane in more detail.
std::vector<Figure> figures_of(const Folder&, const Result&);

/// The command that made a result, for a shell; without its --set of the given parameters.
std::string command_of(const Result&, const std::string& verb, const std::vector<std::string>& varied = {});

}  // namespace rosin::app::report
