/// What all contacts of a structure exert, as functions of the few displacements that they feel: for codes of many
/// coordinates, in which contacts are few.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// Rows B: of each contact its direction of slip, then the normal of each of its stations. With places s = B q and
/// their rates w = B q̇ the forces on the coordinates are Bᵀ f(s, w): on a row of slip friction F(V − w, N), on that of
/// a station −A p(s − gap, w), N = Σ A (bound of p). Dead loads act on the coordinates themselves.
class StationForces {
 public:
  /// \throws InputError for a contact with states of its own: a law that remembers, a spring, a memory of the load.
  explicit StationForces(const Structure&);

  const Eigen::SparseMatrix<double>& rows() const { return B_; }
  int size() const { return int(B_.rows()); }
  /// Of all contacts that press, on the coordinates (N).
  Eigen::VectorXd dead_load(double t) const;

  struct Forces {
    Eigen::VectorXd value;              ///< N, on each row
    Eigen::MatrixXd by_place, by_rate;  ///< N/m, N s/m; blocks of a contact
  };
  /// \param friction  times that of the law
  void evaluate(double t, const Eigen::VectorXd& place, const Eigen::VectorXd& rate, Forces&,
                double friction = 1) const;

  struct Contact {
    int slip = 0;                 ///< row of its slip
    int first = 0, stations = 0;  ///< rows of its stations
    double area = 1;              ///< of them all
    bool presses() const { return stations > 0; }
  };
  const std::vector<Contact>& contacts() const { return contacts_; }
  double speed(int contact, double t) const;
  double load(int contact, double t) const;  ///< prescribed, or the dead load
  /// Approach of a station, a row, at its place: positive where it is pressed (m).
  double approach(int row, const Eigen::VectorXd& place) const { return place[row] - gap_[row]; }
  double area(int row) const { return area_[row]; }  ///< of a station

 private:
  const Structure& structure_;
  std::vector<Contact> contacts_;
  std::vector<std::unique_ptr<rosin::Contact<double>>> law_;
  Eigen::SparseMatrix<double> B_;
  std::vector<int> pressing_;               ///< contacts that press
  Eigen::SparseMatrix<double> directions_;  ///< in which their dead loads act
  Eigen::VectorXd area_, gap_;
};

}  // namespace rosin::oscillators
