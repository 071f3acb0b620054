/// Towers with unknowns in their first direction and the number in their second.
#include "analysis/response/contact_slopes.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "core/tower.hpp"
#include "laws/one_coefficient.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::analysis::response {

namespace {

constexpr int capacity = Slopes<double>::capacity;
using Complex = std::complex<double>;

/// The slope of what a contact is made of by a number of the model.
ContactChange change_by(const Model& model, const ContactSetup& setup, const std::string& path) {
  ContactChange change;
  const double value = model.get(path);
  const auto refuse = [&](const char* why) {
    throw InputError(fmt::format("{} = {}: no slope is taken there, because {}", path, value, why));
  };
  // Springs and dampers beside an undamped spring lie elsewhere in the setup than beside a damped one.
  const bool damped = setup.spring.present();
  const std::pair<const char*, double*> compliances[] = {
      {"law.contact_stiffness.tangential", damped ? &change.setup.spring.compliance : &change.setup.compliance},
      {"law.contact_stiffness.per_load",
       damped ? &change.setup.spring.compliance_per_load : &change.setup.compliance_per_load}};
  for (const auto& [name, slope] : compliances)
    if (path == name) {
      if (!std::isfinite(value)) refuse("a rigid contact has no spring that could yield");
      *slope = -1 / (value * value);
      return change;
    }
  const std::pair<const char*, double*> dampings[] = {
      {"law.contact_stiffness.damping", &change.setup.spring.damping},
      {"law.contact_stiffness.damping_per_load", &change.setup.spring.damping_per_load}};
  for (const auto& [name, slope] : dampings)
    if (path == name) {
      if (model.contact_stiffness.present() && !model.contact_stiffness.damped())
        refuse("a spring without damper is another contact");
      *slope = 1;
      return change;
    }
  if (path == "law.lambda") {
    if (value == 0) refuse("states in equilibrium do not move");
    change.setup.lambda = 1;
    return change;
  }
  constexpr std::string_view of_law = "law.";
  if (!path.starts_with(of_law)) return change;
  const auto name = std::string_view(path).substr(of_law.size());
  const auto both = laws::one_coefficient_of(*model.law);
  change.parameters.assign(model.law->parameters().size(), 0.0);
  if (both && name == both->name) {
    for (const auto one : laws::rest_and_motion) change.parameters[*model.law->find(one)] = 1;
  } else if (const auto index = model.law->find(name)) {
    change.parameters[*index] = 1;
  } else {
    change.parameters.clear();  // of what surrounds the law
  }
  return change;
}

}  // namespace

ContactSetup imposed_contact_setup(Model model) {
  model.slider = {};
  // Without a spring the law is asked at a slip rate and needs no explicit inverse.
  return oscillators::SliderSystem(std::move(model), Unknowns::states).contact_setup();
}

ContactSlopes::ContactSlopes(const Model& model, const ContactSetup& imposed, const std::string& path) {
  by_slip_rate_ = path == "drive.speed" ? 1 : 0;
  by_load_ = path == "drive.normal_load" ? 1 : 0;
  contact_ = model.law->tower(imposed, change_by(model, imposed, path));
}

ContactInput<Tower> ContactSlopes::input(const ContactInput<double>& in, double by_slip_rate) const {
  return {across(in.slip_rate, by_slip_rate, by_slip_rate_), across(in.normal_load, 0, by_load_), in.load_rate,
          in.direction};
}

ContactSlopes::Values ContactSlopes::values(const ContactInput<double>& in, const double* z) const {
  const int n = unknowns();
  Tower unknown[capacity], g[capacity], mass[capacity], F;
  for (int i = 0; i < n; ++i) unknown[i] = z[i];
  const auto at = input(in, 0);
  contact_->evaluate(at, unknown, g, F);
  contact_->mass(at.normal_load, mass);
  Values slopes{{}, {}, F.value.slope[0].value};
  for (int i = 0; i < n; ++i) {
    slopes.mass.push_back(mass[i].value.slope[0].value);
    slopes.g.push_back(g[i].value.slope[0].value);
  }
  return slopes;
}

std::vector<double> ContactSlopes::steady(const ContactInput<double>& in, const double* z,
                                          const std::vector<double>& A) const {
  const int n = unknowns();
  std::vector<double> shift = values(in, z).g;
  if (n == 0) return shift;
  // Of states that stand still in sliding, whose rows are empty, any value is steady: they keep theirs.
  Eigen::MatrixXd matrix =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(A.data(), n, n);
  Eigen::VectorXd right = -Eigen::Map<const Eigen::VectorXd>(shift.data(), n);
  for (int i = 0; i < n; ++i)
    if (const double size = matrix.row(i).cwiseAbs().maxCoeff(); size > 0) matrix.row(i) /= size, right[i] /= size;
  Eigen::VectorXd unit(n);  // of each unknown: columns have units of their own
  for (int i = 0; i < n; ++i) {
    const double size = matrix.col(i).cwiseAbs().maxCoeff();
    unit[i] = size > 0 ? 1 / size : 1;
    matrix.col(i) *= unit[i];
  }
  Eigen::Map<Eigen::VectorXd>(shift.data(), n) =
      unit.cwiseProduct(Eigen::VectorXd(matrix.completeOrthogonalDecomposition().solve(right)));
  return shift;
}

FrictionResponse::Linear ContactSlopes::linear(const ContactInput<double>& in, const double* z,
                                               const std::vector<double>& z_p) const {
  const int n = unknowns();
  const auto count = std::size_t(n);
  FrictionResponse::Linear change{};
  change.mass = values(in, z).mass;
  change.A.resize(count * count);
  change.b_v.resize(count);
  change.c.resize(count);
  for (int moved = 0; moved <= n; ++moved) {  // the unknowns in turn, then the slip rate
    Tower unknown[capacity], g[capacity], F;
    for (int i = 0; i < n; ++i) unknown[i] = across(z[i], i == moved ? 1 : 0, z_p[std::size_t(i)]);
    contact_->evaluate(input(in, moved == n ? 1 : 0), unknown, g, F);
    const auto mixed = [](const Tower& x) { return x.slope[0].slope[0].value; };
    for (int i = 0; i < n; ++i)
      (moved == n ? change.b_v[std::size_t(i)] : change.A[std::size_t(i * n + moved)]) = mixed(g[i]);
    (moved == n ? change.d_v : change.c[std::size_t(moved)]) = mixed(F);
  }
  return change;
}

ResponseSlope::ResponseSlope(const FrictionResponse& response, const Model& model, const std::string& path) {
  // What is left where the parts of an answer cancel, as those of a bristle do in steady sliding.
  const double force = response.friction_coefficient() * response.normal_load(), value = model.get(path);
  rounding_ = value != 0 && std::isfinite(value) ? 1e-13 * std::abs(force / (response.slip_rate() * value)) : 0;
  const ContactSlopes slopes(model, response.setup(), path);
  const auto in = response.input();
  const auto& z = response.steady();
  held_ = slopes.linear(in, z.data(), std::vector<double>(z.size(), 0.0));
  shift_ = slopes.linear(in, z.data(), slopes.steady(in, z.data(), response.linear().A));
  const auto subtract = [](std::vector<double>& from, const std::vector<double>& what) {
    for (std::size_t i = 0; i < what.size(); ++i) from[i] -= what[i];
  };
  subtract(shift_.mass, held_.mass), subtract(shift_.A, held_.A), subtract(shift_.b_v, held_.b_v);
  subtract(shift_.c, held_.c), shift_.d_v -= held_.d_v;
}

ResponseSlope::Answer ResponseSlope::operator()(const FrictionResponse::Passage& at) const {
  // Z = d + c ζ with (s M − A) ζ = b: dZ = dd + dc ζ + χ (db + dA ζ − s dM ζ) with χ (s M − A) = c.
  const auto n = at.answer.size();
  Answer answer{0, 0};
  const auto add = [&](Complex term) { answer.slope += term, answer.error += std::abs(term); };
  for (const auto* part : {&held_, &shift_}) {
    add(part->d_v);
    for (std::size_t i = 0; i < n; ++i) {
      add(part->c[i] * at.answer[i]);
      add(at.weight[i] * part->b_v[i]);
      add(-at.weight[i] * at.s * part->mass[i] * at.answer[i]);
      for (std::size_t j = 0; j < n; ++j) add(at.weight[i] * part->A[i * n + j] * at.answer[j]);
    }
  }
  // Rounding of the terms, which may cancel: that of exponents mu0/a and of the shift among it.
  answer.error = 1e-10 * answer.error + rounding_;
  return answer;
}

}  // namespace rosin::analysis::response
