/// Motion of many coordinates by steps of a given length, with the contacts condensed to the rows that they feel.
#pragma once
#include <Eigen/Core>
#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <memory>

#include "analysis/motion/stepping.hpp"
#include "core/error.hpp"
#include "oscillators/station_forces.hpp"

namespace rosin::analysis::motion {

/// M q̈ + C q̇ + K q = f + dead load + Bᵀ f(B q, B q̇), step by step.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// One step. An Outcome that is not complete where none was found.
  virtual Outcome advance() = 0;
  /// All that the motion depends on from here: displacements, velocities, and as many numbers of the scheme's own.
  virtual Eigen::VectorXd state() const = 0;
  virtual void start(double t, const Eigen::VectorXd& state) = 0;  ///< goes on from there
  double time() const { return t_; }
  const Eigen::VectorXd& coordinates() const { return q_; }
  const Eigen::VectorXd& velocities() const { return v_; }
  const oscillators::StationForces::Forces& forces() const { return forces_; }  ///< of the contacts, at that time
  double kinetic_energy() const { return kinetic_energy_; }
  long iterations() const { return iterations_; }

 protected:
  double t_ = 0, kinetic_energy_ = 0;
  Eigen::VectorXd q_, v_;
  oscillators::StationForces::Forces forces_;
  long iterations_ = 0;
};

/// The structure and the forces outlive it. \throws InputError for an explicit step that the fastest vibration leaves
/// no room for, and for a mass that is not diagonal there
std::unique_ptr<Stepper> make_stepper(const oscillators::Structure&, const oscillators::StationForces&, const Stepping&,
                                      const Eigen::VectorXd& q, const Eigen::VectorXd& v);

/// Longest stable explicit step (s), (2/ω)(√(1 + ξ²) − ξ) of the fastest vibration with its damping ratio ξ.
double longest_explicit_step(const oscillators::Structure&, const oscillators::StationForces&,
                             const Eigen::VectorXd& q);

}  // namespace rosin::analysis::motion
