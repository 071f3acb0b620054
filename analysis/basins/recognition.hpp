/// What a motion comes to: recognised among what is known, or identified.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"
#include "oscillators/structure_system.hpp"

namespace rosin::analysis::basins {

struct Attractor {
  enum class Kind : std::uint8_t {
    steady,    ///< steady sliding that attracts
    rest,      ///< stands still, or moves with the surfaces that it touches
    cycle,     ///< periodic motion that attracts
    escape,    ///< grows without bound
    irregular  ///< none of these within the returns that are allowed
  };
  Kind kind;
  std::map<std::string, cycles::StructureCycle::Measure> metrics;
  std::string detail;                                ///< of irregular motion: why the first was not recognised
  std::map<std::string, std::vector<double>> orbit;  ///< of a cycle: coordinates and velocities along its period
  std::vector<std::vector<double>> points;           ///< of the section that it goes through in a period
  Eigen::VectorXd size;                              ///< of each unknown, by which distances from it are measured
  double radius = 0;                                 ///< within which a motion that comes nearer is recognised
};
std::string name(Attractor::Kind);

/// Known attractors. Those without a place of their own, and steady sliding, have fixed numbers; cycles follow.
class Recogniser {
 public:
  enum Label : std::int8_t { unknown = -1, steady, rest, escape, irregular, first_cycle };
  /// \param most_returns  of the section, within which a motion is recognised
  /// \throws InputError where the drive has no period
  Recogniser(oscillators::Structure, double tolerance, int most_returns);

  const std::vector<Attractor>& known() const { return known_; }
  bool sliding_attracts() const { return !known_[steady].points.empty(); }
  /// Unknowns of steady sliding. \throws InputError where there is none that attracts
  const std::vector<double>& steady_sliding() const;

  /// Follows the motion from a start until it comes near one of the known attractors and nearer from return to return,
  /// comes to rest, or grows without bound. `unknown` where it does none of that.
  /// \param tolerance  of its steps
  int recognise(const std::vector<double>& start, double tolerance) const;

  /// The cycle that a motion comes to, or else what is left if it is not recognised either.
  struct Identified {
    int label = unknown;
    std::optional<cycles::StructureCycle> cycle;
    std::string detail;  ///< of irregular motion
  };
  Identified identify(const std::vector<double>& start) const;
  /// The label, of a cycle that is not yet known a new one.
  int add(const Identified&);

  double step_tolerance() const { return 0.1 * tolerance_; }

 private:
  void find_steady_sliding();
  bool is_same(const Attractor&, const cycles::StructureCycle&) const;
  void take_section_of(const cycles::StructureCycle&, Attractor&) const;
  double distance_from(int attractor, const std::vector<double>& y) const;
  void set_radii();
  bool stands(const oscillators::StructureSystem&, double t, const std::vector<double>& y) const;

  oscillators::Structure structure_;
  double tolerance_;
  int most_returns_;
  bool driven_;
  int watched_ = 0;  ///< the coordinate whose maxima are the section
  Eigen::VectorXd natural_;
  std::vector<Attractor> known_;
};

}  // namespace rosin::analysis::basins
