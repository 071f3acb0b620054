/// Results as JSON: the same text stands in result.json and is printed by --json.
#pragma once
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/curve.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/steady/thresholds.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::output {

/// A steady curve as sampled.
struct Curve {
  std::vector<double> slip_rate, friction_coefficient;
  std::vector<analysis::steady::Extremum> extrema;
};

struct StabilityResult {
  analysis::steady::Stability stability;
  std::vector<analysis::steady::HopfPoint> hopf;
};

struct MapResult {
  analysis::planes::Map map;
  double seconds = 0;
};

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

struct DesignResult {
  analysis::inference::Design design;
  double seconds = 0;
};

/// How a result came about.
struct Manifest {
  std::string verb;
  double tolerance_asked = 0, tolerance_reached = 0;  ///< relative; 0: exact to rounding
  std::map<std::string, double> cost;
  Outcome outcome;
  std::vector<std::string> overrides, files;
  std::map<std::string, std::string> scripts;  ///< for gnuplot, and the checksums by which they are known as ours
};

// Numbers are printed so that they read back the same; what is absent or not finite is null.
std::string to_json(const scene::Scene&, const Manifest&);
/// Of work that ended before there was a result.
std::string to_json(const std::string& verb, const Outcome&);

}  // namespace rosin::app::output
