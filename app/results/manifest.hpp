/// Results as JSON: the same text stands in result.json and is printed by --json.
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::results {

/// How a result came about.
struct Manifest {
  std::string verb;
  double tolerance_asked = 0, tolerance_reached = 0;  ///< relative; 0: exact to rounding
  std::map<std::string, double> cost;
  Outcome outcome;
  std::vector<std::string> overrides, files;
  std::map<std::string, std::string> scripts;  ///< for gnuplot, and the checksums by which they are known as ours
};

nlohmann::ordered_json document_of(const scene::Scene&, const Manifest&);

// Numbers are printed so that they read back the same; what is absent or not finite is null.
std::string to_json(const scene::Scene&, const Manifest&);
/// Of work that ended before there was a result.
std::string to_json(const std::string& verb, const Outcome&);

}  // namespace rosin::app::results
