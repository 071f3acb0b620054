/// A rectangular elastic block on its lower face, as nine-node elements in plane strain: masses, stiffness, the
/// stations at which the face touches, and what is measured of its motion (Oden & Martins 1985, Comput. Methods Appl.
/// Mech. Eng. 52, 527).
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

#include "oscillators/structure.hpp"

namespace rosin::oscillators {

struct ElasticBlock {
  double length = 2, height = 1, thickness = 1;  ///< m, along the belt, away from it, and across
  double youngs_modulus = 20;                    ///< Pa
  double poisson_ratio = 0.3;                    ///< 1, below 0.5
  double density = 0.5;                          ///< kg/m³
  std::array<int, 2> elements = {4, 4};          ///< along and upwards
  bool lumped_mass = false;                      ///< a diagonal mass matrix, by Simpson's weights at the nodes
  int gauss_points = 3;                          ///< stations on each edge of the lower face

  double mass() const { return density * length * height * thickness; }
};

/// Coordinates: the displacements along the belt and upwards of node k are 2k and 2k + 1. Places are from the middle
/// of the lower face.
struct BlockMesh {
  /// \throws InputError for sizes, moduli and numbers of elements outside what an elastic block has.
  explicit BlockMesh(const ElasticBlock&);

  ElasticBlock block;
  Eigen::Matrix2Xd nodes;                    ///< m
  std::vector<std::array<int, 9>> elements;  ///< nodes, along the belt fastest
  Eigen::SparseMatrix<double> M, K;          ///< kg, N/m: of the block alone, free to move

  /// Points of the lower face at which contact is integrated.
  struct Station {
    double place, area;  ///< m, m²
    /// Rows of the slip along the belt and of the approach, the displacement downwards.
    Eigen::VectorXd tangential, normal;
  };
  std::vector<Station> stations;  ///< along the belt

  // Functionals of the displacements, each a row.
  Eigen::VectorXd elongation;  ///< mean displacement along the belt of the face on the left (m), where a spring pulls
  Eigen::VectorXd centre_x, centre_y;  ///< of the centre of mass (m)
  Eigen::VectorXd tilt;                ///< mean rotation by the mass, anticlockwise (rad)
  Eigen::VectorXd weight;              ///< forces of a unit of weight (1), Σ = −1

  int size() const { return int(M.rows()); }
  /// Displacements of the block as a rigid body.
  Eigen::VectorXd rigid(double along, double up, double rotation) const;
  double rotary_inertia() const;  ///< kg m², about the centre of mass
};

/// What holds a block on its belt.
struct BlockOnBelt {
  double spring_stiffness = 0;               ///< N/m, pulls the mean displacement of the left face
  double stiffness_damping = 0;              ///< s: C = stiffness_damping·K of the block
  std::shared_ptr<const NormalLaw> contact;  ///< pressure of the lower face by its approach
};
/// A contact like the one given at each station, that bears its share of the weight, the normal load of the drive.
/// There are more stations than nodes that they move with: what each bears at rest is open (Structure::check()).
Structure block_on_belt(const BlockMesh&, const BlockOnBelt&, const FrictionContact& like);

}  // namespace rosin::oscillators
