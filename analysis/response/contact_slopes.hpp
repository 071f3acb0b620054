/// How a contact in sliding changes with one number of its model: slopes by dual numbers, through the law, all that
/// surrounds it, and the shift of steady sliding.
#pragma once
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "analysis/response/frf.hpp"
#include "core/contact.hpp"
#include "oscillators/model.hpp"

namespace rosin::analysis::response {

/// The setup of the model's contact where the slip rate is imposed, whatever its slider.
ContactSetup imposed_contact_setup(Model);

/// Slopes of a contact by one number p. Those that do not reach into the contact at constant slip rate and load, such
/// as the slider's, have none.
class ContactSlopes {
 public:
  /// \param imposed the model's imposed_contact_setup.
  /// \throws InputError for an unknown path, and where the contact is another one beside the value of p: a spring that
  /// is infinite, a damper or a λ that is 0.
  ContactSlopes(const Model&, const ContactSetup& imposed, const std::string& path);

  /// ∂M/∂p, ∂g/∂p (unknowns) and ∂F/∂p at unknowns z that stand.
  struct Values {
    std::vector<double> mass, g;
    double F;
  };
  Values values(const ContactInput<double>&, const double* z) const;

  /// dz/dp of steady sliding at z, where g(z, p) = 0 has the slope A = ∂g/∂z (row-major).
  std::vector<double> steady(const ContactInput<double>&, const double* z, const std::vector<double>& A) const;

  /// d/dp of the linear contact (M, A, b_v, c and d_v alone) at unknowns that move by z_p.
  FrictionResponse::Linear linear(const ContactInput<double>&, const double* z, const std::vector<double>& z_p) const;

 private:
  int unknowns() const { return contact_->unknowns(); }
  ContactInput<Tower> input(const ContactInput<double>&, double by_slip_rate) const;

  double by_slip_rate_ = 0, by_load_ = 0;  ///< 1 where p is the drive's speed or load
  std::unique_ptr<const ContactValues<Tower>> contact_;
};

/// ∂Z/∂p of the tangential response, exact but for rounding.
class ResponseSlope {
 public:
  /// \param response that of the model.
  /// \throws InputError as ContactSlopes.
  ResponseSlope(const FrictionResponse& response, const Model&, const std::string& path);
  struct Answer {
    std::complex<double> slope;
    double error;
  };
  Answer operator()(const FrictionResponse::Passage&) const;

 private:
  double rounding_;                        ///< N s/m per unit of p
  FrictionResponse::Linear held_, shift_;  ///< d/dp at unknowns that stand, and by the shift of steady sliding
};

}  // namespace rosin::analysis::response
