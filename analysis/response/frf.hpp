/// Friction frequency response: how friction answers small changes of slip rate and normal load about steady sliding.
///
/// A contact M ż = g(v, N, Ṅ, z), F(v, N, Ṅ, z) is linear for small changes: Z(s) = δF/δv = F_v + F_z (s M − g_z)⁻¹
/// g_v, exact for any law, any number of states and any wrapper, because only the contact's own derivatives enter. With
/// one state, Z = N μ_v (s + g r)/(s + g), r = μ_ss'/μ_v. Sources: Woodhouse, Putelat & McKay (2015), section 3;
/// Cabboi, Putelat & Woodhouse (2016).
#pragma once
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "oscillators/model.hpp"

namespace rosin::analysis::response {

using oscillators::Model;

/// How the normal load answers motion: δN = Z_n(s) δw + lift·δv, Z_n = k_n/s + c_n, w the speed of approach.
struct NormalContact {
  double stiffness = 0;  ///< k_n, N/m
  double damping = 0;    ///< c_n, N s/m
  double lift = 0;       ///< load gained by slip rate, N s/m; negative where a film or dilatancy lifts the slider off
};

/// What a normal contact is given by.
inline constexpr Field<NormalContact, double> normal_contact_fields[] = {
    field(&NormalContact::stiffness, "stiffness", "N/m", {0, 1e15}, "normal stiffness of the contact"),
    field(&NormalContact::damping, "damping", "N s/m", {0, 1e15}, "normal damping of the contact"),
    field(&NormalContact::lift, "lift", "N s/m", {-1e15, 1e15}, "load gained by slip rate")};

/// How a response is measured.
struct Rig {
  double sensor_mass = 0;  ///< kg of live mass between contact and force sensor: adds m s
  bool matrix = false;     ///< under normal changes too
  std::optional<NormalContact> normal;
};

/// [δF; δN] = [tt tn; nt nn] [δv; δw]; without a normal contact the load is prescribed and [δv; δN] are the inputs.
struct ResponseMatrix {
  std::complex<double> tt, tn, nt, nn;
};

/// The matrix of δF/δv at fixed load and δF/δN at fixed slip rate, with the normal contact around them if there is one.
ResponseMatrix response_matrix(std::complex<double> s, std::complex<double> by_slip_rate, std::complex<double> by_load,
                               const std::optional<NormalContact>&);

/// The linear answer of a contact about steady sliding at the levels of the drive's speed and load. Needs no slider.
class FrictionResponse {
 public:
  /// \throws InputError without a drive speed, or where steady sliding has no finite derivatives.
  explicit FrictionResponse(const Model&);

  /// Z(s) = δF/δv at fixed load, N s/m. At s = iω the phase is that by which force leads slip rate.
  std::complex<double> tangential(std::complex<double> s) const;
  /// δF/δN at fixed slip rate; for friction proportional to load and states that do not know it, μ_ss.
  std::complex<double> normal(std::complex<double> s) const;
  ResponseMatrix matrix(std::complex<double> s, const std::optional<NormalContact>& = {}) const;
  /// The same as the force sensor of a rig sees them, with the inertia of its live mass.
  std::complex<double> tangential(std::complex<double> s, const Rig&) const;
  ResponseMatrix matrix(std::complex<double> s, const Rig&) const;

  /// What Z tends to: N μ_ss' for s → 0; for s → ∞ N μ_v, or, where that is 0, stiffness/s.
  struct Limits {
    double low, high;  ///< N s/m
    double stiffness;  ///< N/m; 0 unless high is 0
  };
  Limits limits() const;

  struct Root {
    std::complex<double> value;  ///< 1/s
    double error;                ///< absolute, 1/s
  };
  /// Decay rates of the contact by itself, at a prescribed slip rate; and the s at which the force does not answer.
  std::vector<Root> poles() const;
  std::vector<Root> zeros() const;

  /// The amplitude of slip rate (m/s) at which the second harmonic of the force reaches `share` of the first, by the
  /// second-order response of the contact: linear theory holds well below it. Infinite where there is no such harmonic.
  double amplitude_of_harmonic(double angular_frequency, double share) const;

  /// x of (s M − A) x = b.
  std::vector<std::complex<double>> solve(std::complex<double> s, const std::vector<std::complex<double>>& b) const;

  /// What lies between slip rate and force: the unknowns' answer ζ, (s M − A) ζ = b_v, and what force has of a source
  /// in each row, χ (s M − A) = c.
  struct Passage {
    std::complex<double> s;
    std::vector<std::complex<double>> answer, weight;
    std::complex<double> force;  ///< Z
  };
  Passage passage(std::complex<double> s) const;

  double slip_rate() const { return slip_rate_; }
  double normal_load() const { return normal_load_; }
  double friction_coefficient() const { return friction_ / normal_load_; }

  /// The same as matrices: M ż = A z + b_v v + b_N N + b_R Ṅ, F = c z + d_v v + d_N N + d_R Ṅ. A row-major.
  struct Linear {
    std::vector<double> mass, A, b_v, b_N, b_R, c;
    double d_v, d_N, d_R;
    int size() const { return int(mass.size()); }
  };
  const Linear& linear() const { return linear_; }
  /// Unknowns of the contact in steady sliding, and what is imposed on it.
  const std::vector<double>& steady() const { return steady_; }
  ContactInput<double> input() const { return {slip_rate_, normal_load_, 0, direction_}; }
  const ContactSetup& setup() const { return setup_; }

 private:
  ContactSetup setup_;
  Linear linear_;
  std::vector<double> steady_;
  std::shared_ptr<const ContactValues<Tower>> tower_;
  double slip_rate_, normal_load_, friction_, direction_;
};

/// What is asked of a prediction.
struct FrfOptions {
  std::vector<double> frequencies;  ///< Hz, ascending
  Rig rig;
  std::vector<std::string> sensitivities;  ///< paths of parameters
  std::string family;                      ///< path of a parameter, or empty
  std::vector<double> family_values;
};

/// A prediction at one parameter set.
struct FrfCurve {
  double value = 0;  ///< of the family's parameter
  std::vector<std::complex<double>> tangential;
  std::vector<ResponseMatrix> matrix;
  std::vector<double> linear_amplitude;  ///< m/s: second harmonic of 1 %
  FrictionResponse::Limits limits{};
  std::vector<FrictionResponse::Root> poles, zeros;
  double slip_rate = 0, normal_load = 0, friction_coefficient = 0;
};

/// ∂Z/∂p at every frequency, and its error.
struct FrfSensitivity {
  std::string parameter, unit;
  std::vector<std::complex<double>> slope;
  std::vector<double> error;
};

struct FrfPrediction {
  FrfCurve curve;
  std::vector<FrfSensitivity> sensitivities;
  std::vector<FrfCurve> family;
  /// Of a family over load: d ln|Z|/d ln N at every frequency, by least squares over the family; 1 where |Z| scales
  /// with load, 0 where it does not know it.
  std::vector<double> load_exponent;
};

/// \throws InputError for a parameter that does not exist or leaves its range.
FrfPrediction predict_frf(const Model&, const FrfOptions&);

/// ∂Z/∂p of each parameter at frequencies (Hz), exact but for rounding. \throws InputError where the contact is another
/// one beside the value of p: a spring that is infinite, a damper or a λ that is 0.
std::vector<FrfSensitivity> frf_sensitivities(const Model&, const std::vector<std::string>& parameters,
                                              const std::vector<double>& frequencies);

}  // namespace rosin::analysis::response
