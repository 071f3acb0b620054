/// A structure of many coordinates reduced to those that its contacts move and the slowest modes of the others
/// (Craig & Bampton 1968, AIAA J. 6, 1313).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "oscillators/block.hpp"

namespace rosin::oscillators {

/// Coordinates q = basis · (those that contacts move, amplitudes of modes, sinking). The modes are those with the
/// contacts held. Others follow the contacts as they would at rest, by the whole K, springs to the frame included, and
/// sink under the load of the contacts as they would: steady sliding is exact with any number of modes.
struct Reduction {
  /// \param modes  of lowest frequency that are kept, each scaled to a largest displacement of 1
  /// \throws InputError for fewer than 0 and for more than there are, and where nothing else holds a structure whose
  /// contacts are held
  Reduction(Structure whole, int modes);

  Structure whole;                ///< n coordinates, without forces and stops
  Structure reduced;              ///< m coordinates, whose modes are named mode_1 …
  Eigen::MatrixXd basis;          ///< n × m
  std::vector<int> touching;      ///< coordinates of the whole that contacts move, the first of the reduced
  std::vector<double> frequency;  ///< Hz, of all modes with the contacts held, ascending
  int modes = 0;                  ///< that are kept

  /// Displacements of the whole as coordinates of the reduced structure: as they are where contacts move them, and
  /// elsewhere as near as modes come, by kinetic energy.
  Eigen::VectorXd coordinates(const Eigen::VectorXd& displacements) const;
};

/// A block whose structure is reduced.
struct ReducedBlock {
  BlockMesh mesh;
  Reduction reduction;
};

}  // namespace rosin::oscillators
