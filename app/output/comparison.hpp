/// What stands side by side where models are compared.
#pragma once
#include <string>
#include <vector>

#include "analysis/planes/map.hpp"
#include "app/output/comparison.hpp"
#include "core/error.hpp"

namespace rosin::app::output {

/// Members of a comparison under one protocol.
struct Comparison {
  struct Row {
    std::string metric, unit;
    std::vector<double> values, errors;  ///< one for each member; NaN where it has none
  };
  std::vector<Row> rows;
  /// What is drawn one over the other: of each member x and columns.
  struct Series {
    std::vector<double> x;
    std::vector<std::vector<double>> columns;
  };
  std::string x_name, x_unit;
  std::vector<std::string> column_names, column_units;
  std::vector<Series> series;
  std::vector<analysis::planes::Map> maps;  ///< of protocol "map"
  Outcome outcome;
};

}  // namespace rosin::app::output
