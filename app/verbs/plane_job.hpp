/// What the verbs map and merge have in common: the plane that a scene asks for, and its results.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "analysis/planes/map.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/planes/varied.hpp"
#include "app/verbs/job.hpp"

namespace rosin::app::verbs {

/// The command that asks a verb about the same plane, `map` for one share of it.
std::string command_of(const Request&, const std::string& verb, analysis::planes::Share = {});

/// The oscillator of a scene that [map] was read of.
analysis::planes::Varied varied(const scene::Scene&);

struct MapResult {
  analysis::planes::Map map;
  double seconds = 0;
};

/// Metrics of the structure in the scene, or of the oscillator that is followed by steps. \throws InputError for an
/// unknown name
std::vector<analysis::planes::PlaneMetric> metrics_of(const scene::Scene&, const std::vector<std::string>& names);

/// s, between returns of a motion of the scene: the period of its drive; infinite: not known.
double mean_return_of(const scene::Scene&);

/// A plane for files: regimes, metrics with their errors, and its threshold and fold.
results::Table table_of(const scene::Scene&, const analysis::planes::Map&);

struct PlaneJob {
  explicit PlaneJob(Job&);
  analysis::planes::Map compute(const analysis::planes::MapHooks& hooks) const {
    return varied(job.scene()).map(options, hooks);
  }
  /// Says what was found, draws it and writes it. `costs`: processor time (s) of parts, as far as they are known.
  Status write(const MapResult&, const std::map<std::size_t, double>& costs) const;

  Job& job;
  analysis::planes::MapOptions& options;
  bool of_slider = true;  ///< the plane is a slider's, with its shortcuts; else each point is computed by itself
  std::vector<analysis::planes::PlaneMetric> metrics;
  std::string key;  ///< everything that determines the plane: two with the same key have the same points
  std::size_t points = 0;
};

}  // namespace rosin::app::verbs
