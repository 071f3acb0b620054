/// An oscillator whose numbers are varied by their paths, as planes and designs ask of it.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analysis/motion/structure_start.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Numbers by their paths.
using Numbers = std::vector<std::pair<std::string, double>>;

/// Structures that differ in numbers, and the number that theirs is where none is given.
struct Structures {
  std::function<motion::StructureModel(const Numbers&)> with;
  std::function<double(const std::string& path)> value;
};

/// A slider by the parameters of its model, or a member of a family of structures.
class Varied {
 public:
  Varied(Model model) : model_(std::move(model)) {}
  explicit Varied(Structures structures) : structures_(std::move(structures)) {}

  /// \throws InputError for a path that names no number.
  double get(const std::string& path) const;
  /// \throws InputError as that, and for a number out of range.
  Varied with(const std::string& path, double value) const;
  /// \throws InputError for a metric that the oscillator has not.
  std::vector<PlaneMetric> metrics(const std::vector<std::string>& names) const;
  /// The plane of the options' metrics.
  Map map(const MapOptions&, const MapHooks& = {}) const;
  /// Metrics in steady sliding, by their names; a period and what adds up over one has none.
  std::map<std::string, double> in_steady_sliding() const;

 private:
  motion::StructureModel structure(Numbers more = {}) const;

  Model model_;
  Structures structures_;  ///< empty: the slider of the model
  Numbers changed_;
};

}  // namespace rosin::analysis::planes
