/// What all JSON documents of results have in common. Include only in .cpp files: the JSON library is slow to compile.
#pragma once
#include <complex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/scene.hpp"

namespace rosin::app {

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

/// What every document of a scene begins with.
inline ordered_json begin(const Scene& scene, const char* verb, const Outcome& outcome = {}) {
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

}  // namespace rosin::app
