/// How far a motion goes, and distances by that measure.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "oscillators/structure_system.hpp"

namespace rosin::analysis::cycles {

/// The coordinate that moves most, by the range of each in parts of its natural size. One that friction holds on a
/// surface at rest stands still for as long as that sticks, so that it has no single moment of its maximum: others come
/// before it.
template <class Part>
int coordinate_of_section(const oscillators::Structure& structure, const Part& part) {
  constexpr double hardly = 1e-3;
  const auto weight = [&](int i) { return structure.stands_still(i) ? hardly * part(i) : part(i); };
  int best = 0;
  for (int i = 1; i < structure.size(); ++i)
    if (weight(i) > weight(best)) best = i;
  return best;
}

/// Size of each unknown in a motion: the range that it has gone through, which a coordinate that hardly moves shares
/// with the largest.
class MotionRange {
 public:
  explicit MotionRange(const oscillators::StructureSystem& system) : system_(system) {}
  void begin(const std::vector<double>& y) { low_ = high_ = y; }
  void add(const std::vector<double>& y) {
    for (std::size_t i = 0; i < y.size(); ++i) low_[i] = std::min(low_[i], y[i]), high_[i] = std::max(high_[i], y[i]);
  }
  /// Half ranges, at least 1e-3 of those of the largest coordinate and speed.
  Eigen::VectorXd size() const {
    const int n = system_.coordinates();
    Eigen::VectorXd half(low_.size());
    for (std::size_t i = 0; i < low_.size(); ++i) half[Eigen::Index(i)] = 0.5 * (high_[i] - low_[i]);
    std::vector<double> natural(low_.size());
    system_.scale(high_.data(), natural.data());
    constexpr double least = 1e-3, least_of_natural = 1e-9;
    for (const auto& [first, count] : {std::pair{0, n}, std::pair{n, n}}) {
      const double largest = half.segment(first, count).maxCoeff();
      for (int i = first; i < first + count; ++i) half[i] = std::max(half[i], least * largest);
    }
    for (Eigen::Index i = 0; i < half.size(); ++i) half[i] = std::max(half[i], least_of_natural * natural[i]);
    for (Eigen::Index i = 2 * n; i < half.size(); ++i) half[i] = std::max(half[i], least * natural[i]);
    return half;
  }
  /// The coordinate whose maxima are a section, as coordinate_of_section() has it.
  int widest() const {
    std::vector<double> natural(low_.size());
    system_.scale(std::vector<double>(low_.size()).data(), natural.data());
    return coordinate_of_section(system_.structure(), [&](int i) { return (high_[i] - low_[i]) / natural[i]; });
  }

 private:
  const oscillators::StructureSystem& system_;
  std::vector<double> low_, high_;
};

/// The largest difference of an unknown, in sizes.
inline double distance(const std::vector<double>& a, const std::vector<double>& b, const Eigen::VectorXd& size) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]) / size[Eigen::Index(i)]);
  return largest;
}

}  // namespace rosin::analysis::cycles
