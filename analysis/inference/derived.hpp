/// Numbers that follow from those of a scene by a formula: a − b, the critical stiffness, a hardness.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/inference/machine.hpp"
#include "laws/tape.hpp"

namespace rosin::analysis::inference {

/// A formula over numbers of a scene by their paths, in SI, with its unit and its slopes by each of them. A value.
class DerivedNumber {
 public:
  /// \param text as in laws/expression.hpp, with paths as names: "drive.normal_load*(law.b - law.a)/law.L"
  /// \throws InputError for text that is no formula, for a path that names no number of the subject, with the nearest,
  /// and for units that do not fit
  DerivedNumber(std::string name, std::string_view text, const Subject&);

  const std::string& name() const { return name_; }
  const std::string& text() const { return text_; }
  const std::string& unit() const { return unit_; }
  const std::vector<std::string>& paths() const { return paths_; }  ///< each that is used, once

  struct Value {
    double value;
    std::vector<double> slopes;  ///< by each path
  };
  /// \param numbers at each path, SI
  Value at(std::span<const double> numbers) const;

 private:
  std::string name_, text_, unit_;
  std::vector<std::string> paths_;
  laws::Tape tape_;  ///< the value, then the slopes
  std::vector<double> constants_;
};

}  // namespace rosin::analysis::inference
