/// What the verb branch is asked.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/branches/branches.hpp"
#include "analysis/motion/structure_start.hpp"
#include "core/parameters.hpp"

namespace rosin::app::tasks {

/// A parameter along which steady sliding and cycles are followed.
struct Branch {
  Quantity parameter;
  bool from_cycle = false;  ///< from the motion that has settled at the first value, else from steady sliding
  /// Where a motion starts: of a structure, or of a slider that settles as one; of others.
  struct Start {
    std::optional<analysis::motion::StructureStart> structure = {};
    std::optional<analysis::motion::Start> slider = {};
  };
  std::vector<Start> starts;  ///< one for each motion that is followed; empty: the usual one
  analysis::branches::BranchOptions options;
  /// A second parameter, in which the points where branches change are followed.
  struct Locus {
    Quantity parameter;
    double value = 0;  ///< of the scene
    analysis::branches::LocusOptions options;
  };
  std::optional<Locus> locus;
};

/// A special point as AUTO-07p and MatCont call it; empty where neither knows it.
inline std::string label_of(const std::string& kind) {
  constexpr std::pair<std::string_view, const char*> labels[] = {
      {"hopf", "H"},           {"fold", "LP"},          {"period-doubling", "PD"}, {"torus", "NS"},
      {"grazing", "GR"},       {"bautin", "GH"},        {"bogdanov-takens", "BT"}, {"zero-hopf", "ZH"},
      {"resonance-1:1", "R1"}, {"resonance-1:2", "R2"}, {"resonance-1:3", "R3"},   {"resonance-1:4", "R4"},
      {"cusp", "CP"}};
  for (const auto& [name, label] : labels)
    if (name == kind) return label;
  return "";
}

}  // namespace rosin::app::tasks
