/// A structure with friction contacts: M q̈ + C q̇ + K q = f(t) + Σ t F, any number of coordinates and contacts.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "oscillators/model.hpp"

namespace rosin::oscillators {

/// A contact of a structure with a surface that moves. Friction F on the structure acts along t where the surface is
/// the faster.
struct FrictionContact {
  std::shared_ptr<const FrictionLaw> law;
  double lambda = 1;  ///< clock factor of the law's states
  ContactStiffness stiffness;
  double load_memory = 0;
  Eigen::VectorXd tangential;  ///< t: the slip rate is speed − tᵀ q̇
  Signal speed = 1.0;          ///< of the surface, m/s
  Signal normal_load = 1.0;    ///< N
  double load_factor = 1;      ///< times normal_load: the load of this contact
};

/// Coordinates q (m) from the place where springs are relaxed.
struct Structure {
  Eigen::MatrixXd M, C, K;         ///< kg, N s/m, N/m; n × n
  std::vector<Signal> force;       ///< N on each coordinate; empty: none
  std::vector<std::string> names;  ///< of the coordinates, for columns and messages
  std::vector<FrictionContact> contacts;

  int size() const { return int(M.rows()); }
  bool constant() const;
  /// \throws InputError for sizes that do not fit, an M that is not symmetric and positive definite, contacts that
  /// stick along directions that depend on each other, and parts of a contact that do not go together.
  void check() const;
};

/// Block on a belt (mass, spring, damper) before a second mass that is held by a spring and a damper of its own:
/// m ẍ = −k (x − y) − c (ẋ − ẏ) + F + f, m₂ ÿ = k (x − y) + c (ẋ − ẏ) − k₂ y − c₂ ẏ.
struct TwoMassBelt {
  Slider block, second;
};
Structure two_mass_belt(const TwoMassBelt&, const FrictionContact&, const Signal& force);

/// Blocks in a row: `coupling` between neighbours, `pull` from each to the fixed frame; masses of their own.
/// \param contacts  one for each block; their directions are set here
struct Chain {
  std::vector<double> mass, coupling_stiffness, coupling_damping, pull_stiffness, pull_damping;
};
/// \throws InputError for lists that do not fit: n masses, n − 1 couplings, n pulls.
Structure chain(const Chain&, std::vector<FrictionContact> contacts);

}  // namespace rosin::oscillators
