/// What all JSON documents of results have in common. Include only in .cpp files: the JSON library is slow to compile.
#pragma once
#include <complex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/scene/scene.hpp"
#include "core/error.hpp"

namespace rosin::analysis::cycles {
struct Metrics;
}
namespace rosin::analysis::planes {
struct Axis;
}

namespace rosin::app::output {

using nlohmann::ordered_json;

inline std::string text(const ordered_json& document) {
  return document.dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';  // paths need not be UTF-8
}

inline ordered_json pair(std::complex<double> z) { return {z.real(), z.imag()}; }

inline ordered_json pairs(const std::vector<std::complex<double>>& list) {
  auto array = ordered_json::array();
  for (const auto& z : list) array.push_back(pair(z));
  return array;
}

/// Parameters by name.
ordered_json values(const std::vector<Quantity>& names, const std::vector<Value>& list);
/// States by name.
ordered_json states(const FrictionLaw&, std::span<const double> state);
ordered_json axis(const analysis::planes::Axis&, const scene::Scene&);

/// Row by row: [iy][ix] of f(index of the point).
template <class Plane, class F>
ordered_json grid(const Plane& plane, F f) {
  auto table = ordered_json::array();
  const auto width = plane.x.values.size();
  for (std::size_t iy = 0; iy < plane.y.values.size(); ++iy) {
    auto row = ordered_json::array();
    for (std::size_t ix = 0; ix < width; ++ix) row.push_back(f(iy * width + ix));
    table.push_back(std::move(row));
  }
  return table;
}
/// The same of f(point).
template <class Map, class F>
ordered_json rows(const Map& map, F f) {
  return grid(map, [&](std::size_t i) { return f(map.points[i]); });
}

/// What an event says if it is one of a stop.
template <class Event>
void add_stop(ordered_json& entry, const Event& event) {
  if (event.coordinate > 0) entry["coordinate"] = event.coordinate;
  if (event.kind == "impact") entry["speed"] = event.speed;
}

/// What every document of a scene begins with.
inline ordered_json begin(const scene::Scene& scene, const char* verb, const Outcome& outcome = {}) {
  ordered_json document{{"title", scene.title}, {"verb", verb}};
  if (const auto& law = scene.model.law) {  // measured responses need none
    document["law"] = law->card().name;
    if (!law->approximation().empty()) document["approximation"] = law->approximation();
  }
  document["version"] = ROSIN_VERSION;
  document["outcome"] = name(outcome.ending);
  if (!outcome.detail.empty()) document["outcome_detail"] = outcome.detail;
  return document;
}

}  // namespace rosin::app::output
