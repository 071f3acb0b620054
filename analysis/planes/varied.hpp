/// An oscillator whose numbers are varied by their paths, as planes and designs ask of it.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "analysis/motion/stepped_oscillator.hpp"
#include "analysis/motion/structure_start.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Numbers by their paths.
using Numbers = std::vector<std::pair<std::string, double>>;

/// Oscillators that differ in numbers, and the number that theirs is where none is given.
template <class Oscillator>
struct VariedFamily {
  std::function<Oscillator(const Numbers&)> with;
  std::function<double(const std::string& path)> value;
};
using Structures = VariedFamily<motion::StructureModel>;
using SteppedOscillators = VariedFamily<motion::SteppedOscillator>;

/// A slider by the parameters of its model, or a member of a family of structures or of oscillators followed by steps.
class Varied {
 public:
  Varied(Model of) : of_(std::move(of)) {}
  explicit Varied(Structures of) : of_(std::move(of)) {}
  explicit Varied(SteppedOscillators of) : of_(std::move(of)) {}

  /// \throws InputError for a path that names no number.
  double get(const std::string& path) const;
  /// \throws InputError as that, and for a number out of range.
  Varied with(const std::string& path, double value) const;
  /// \throws InputError for a metric that the oscillator has not.
  std::vector<PlaneMetric> metrics(const std::vector<std::string>& names) const;
  /// The plane of the options' metrics.
  Map map(const MapOptions&, const MapHooks& = {}) const;
  /// Metrics in steady sliding, by their names; a period and what adds up over one has none, and of what is followed by
  /// steps none is known.
  std::map<std::string, double> in_steady_sliding() const;

 private:
  Numbers numbers(Numbers more = {}) const;

  std::variant<Model, Structures, SteppedOscillators> of_;
  Numbers changed_;  ///< of a family
};

}  // namespace rosin::analysis::planes
