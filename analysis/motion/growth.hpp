/// Exponential growth of a motion that nothing bounds.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "oscillators/structure_system.hpp"

namespace rosin::analysis::motion {

/// The largest coordinate passes decades of its natural size. Growth is exponential where the third three of twelve
/// take no more than twice as long as the second, and the fourth no more than twice as long as the third: of a motion
/// that grows as t² each three take 30 times as long as those before.
class Growth {
 public:
  explicit Growth(const oscillators::StructureSystem&);
  /// After a step. True where growth is exponential and has come to the last decade.
  bool continues(double step, const std::vector<double>& y);
  double rate() const;  ///< 1/s, over the last six decades: of an oscillation known to its swings
  std::string described(double t) const;

 private:
  static constexpr int decades = 12;
  std::vector<double> size_;                ///< natural, of each coordinate
  std::array<double, decades + 1> passed_;  ///< s, since the beginning, at each decade
  double time_ = 0;
  int next_ = 0;
};

}  // namespace rosin::analysis::motion
