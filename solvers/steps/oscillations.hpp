/// The oscillating modes at a step of the collocation: the error of a step that passes over them, and their growth.
#pragma once
#include <complex>
#include <span>
#include <vector>

#include "core/eigenpairs.hpp"
#include "solvers/steps/radau_tableau.hpp"

namespace rosin::solvers::steps {

/// The modes of M ẏ = J y, kept from step to step while J hardly changes.
class Oscillations {
 public:
  Oscillations(const RadauTableau&, int unknowns, double tolerance);

  /// An attempted step. Matrices are row-major; all data outlive the call.
  struct Step {
    double length;
    double resolved_growth;  ///< largest growth z = λ·length resolved to the tolerance
    const std::vector<double>&y, &mass, &jacobian, &scale;
    const std::vector<double>& filter;  ///< γM/length − J, factorised
    const std::vector<int>& pivot;
    std::span<const double> estimate;  ///< embedded estimate, filtered once
    double size;                       ///< size of the estimate, in scales
  };
  /// Error of the ringing modes, in scales; infinite if an oscillation grows faster than the step resolves. Does not
  /// allocate.
  double error(const Step&);
  /// The longest step that resolves the fastest growing oscillation at the last step of error().
  double longest_step() const { return longest_step_; }
  /// Accepts the last step of error().
  void accept();
  /// Upper bound, for each unknown, of the errors by passed-over oscillations since construction.
  std::span<const double> passed_over() const { return passed_over_; }
  /// Forgets the modes, so that neither cost nor result of a solution depends on earlier ones.
  void forget();

 private:
  struct Moving;
  struct Ringing {
    int mode;
    std::complex<double> z;
  };
  bool find_modes(const Step&, const Moving&);
  bool known_modes_hold(const Step&, const Moving&);
  bool note_mode(const Step&, int mode, bool pair, std::complex<double> z, double radius);
  double sum_of_errors(const Step&, const Moving&);

  const RadauTableau& tableau_;
  double tolerance_;
  double longest_step_;
  bool outgrown_ = false;         ///< an oscillation, however small, grows faster than the step resolves
  std::vector<Ringing> ringing_;  ///< ringing modes at the last step
  /// Eigenvectors of the moving unknowns in columns, their inverse, both column-major, and rates (1/s). A complex pair
  /// is stored as real and imaginary part of the vector with positive frequency, whose rate stands twice.
  std::vector<double> modes_, inverse_;
  std::vector<std::complex<double>> rates_;
  std::vector<double> passed_over_, in_step_;  ///< for each unknown
};

}  // namespace rosin::solvers::steps
