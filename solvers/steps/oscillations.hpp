/// The oscillations beside a step of the collocation: what the step passes over of them, and how fast they grow.
#pragma once
#include <complex>
#include <span>
#include <vector>

#include "core/eigenpairs.hpp"
#include "solvers/steps/radau_tableau.hpp"

namespace rosin::solvers::steps {

/// What differs from rest in M ẏ = J y moves in modes. They are kept from step to step while J hardly changes.
class Oscillations {
 public:
  Oscillations(const RadauTableau&, int unknowns, double tolerance);

  /// A step that is tried. All of its parts are row-major where they are matrices, and outlive the call.
  struct Step {
    double length;
    double followed;  ///< growth z = λ·length that it follows to the tolerance
    const std::vector<double>&y, &mass, &jacobian, &scale;
    const std::vector<double>& filter;  ///< γM/length − J, factorised
    const std::vector<int>& pivot;
    std::span<const double> estimate;  ///< embedded, filtered once
    double size;                       ///< of the estimate, in scales
  };
  /// The error of what rings, in scales; infinite if an oscillation grows beyond what the step follows. Does not
  /// allocate.
  double error(const Step&);
  /// The longest step that follows the oscillation which grew fastest beside the last step asked about.
  double longest_step() const { return longest_step_; }
  /// The last step asked about was taken.
  void accept();
  /// What steps have passed over since this was made, for each unknown and at most.
  std::span<const double> passed_over() const { return passed_over_; }
  /// Forgets modes, so that what a solution costs and gives does not depend on those before it.
  void forget();

 private:
  struct Moving;
  struct Ringing {
    int mode;
    std::complex<double> z;
  };
  bool find(const Step&, const Moving&);
  bool known_serve(const Step&, const Moving&);
  bool note(const Step&, int mode, bool pair, std::complex<double> z, double radius);
  double sum_of_errors(const Step&, const Moving&);

  const RadauTableau& tableau_;
  double tolerance_;
  double longest_step_;
  bool outgrown_ = false;         ///< by an oscillation that grows notably in a turn, however small it is
  std::vector<Ringing> ringing_;  ///< beside the last step
  /// Vectors in columns, of the moving unknowns alone, the inverse of that, both column-major, and rates (1/s). Of a
  /// pair the real and the imaginary part of the one with the positive frequency, which stands twice among the rates.
  std::vector<double> modes_, inverse_;
  std::vector<std::complex<double>> rates_;
  std::vector<double> passed_over_, in_step_;  ///< for each unknown
};

}  // namespace rosin::solvers::steps
