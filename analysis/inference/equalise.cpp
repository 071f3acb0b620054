/// Properties of laws, and the adjustment of parameters to them.
#include "analysis/inference/equalise.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "analysis/motion/run.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::inference {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr std::array<PropertyName, 5> names{{
    {"steady-friction", "1", "coefficient of steady sliding"},
    {"steady-slope", "1", "change of the steady coefficient with the logarithm of slip rate"},
    {"direct-effect", "1", "change of the coefficient with the logarithm of slip rate while states are held"},
    {"fracture-energy", "m", "work above residual friction after a step in slip rate, per unit normal load"},
    {"static-peak", "1", "coefficient when slip resumes after a hold"},
}};

/// The law linearised in steady sliding, with its states as unknowns.
struct Linearised {
  Linearised(const Model& model, double V, double N) {
    const auto contact = model.law->contact({.lambda = model.lambda, .unknowns = Unknowns::states});
    double z[Slopes<double>::capacity], weight[Slopes<double>::capacity], g[Slopes<double>::capacity], F;
    contact->steady(0, V, N, z, weight);
    contact->linearise({V, N, 0, 1}, z, g, F, slopes);
    states = contact->unknowns();
  }
  Slopes<double> slopes;
  int states;
};

/// The slowest relaxation of the states in steady sliding, s.
double relaxation_time(const Model& model, double V, double N) {
  const Linearised law(model, V, N);
  double slowest = 0;
  for (int i = 0; i < law.states; ++i) slowest = std::max(slowest, -1 / law.slopes.g_z[i * law.states + i]);
  return model.lambda * slowest;
}

/// The model's law under imposed slip rate.
Model imposed(const Model& model, Signal slip_rate) {
  Model rig = model;
  rig.contact_stiffness = {};
  rig.slider = {.mass = 0, .stiffness = infinity, .damping = 0};
  rig.drive = {.speed = std::move(slip_rate), .normal_load = model.drive.normal_load.level(), .force = 0.0};
  return rig;
}

motion::Run complete_run(const Model& model, const motion::RunOptions& options) {
  motion::Run result = motion::run(model, options);
  end_if_stopped();
  if (!result.outcome.complete())
    throw InputError(fmt::format("a property of law '{}' could not be computed: {}: {}", model.law->card().name,
                                 name(result.outcome.ending), result.outcome.detail));
  return result;
}

void require_states(const Property& property, const Model& model) {
  if (!model.law->has_states() || model.lambda == 0)
    throw InputError(
        fmt::format("law '{}' has no {}: without states of their own pace nothing relaxes or heals (property)",
                    model.law->card().name, property.name));
}

double fracture_energy(const Property& property, const Model& model, double N) {
  require_states(property, model);
  const double V = property.slip_rate, after = property.ratio * V;
  // Gauss's rule on panels of the logarithm of time: from long before anything changes to long after.
  using Rule = boost::math::quadrature::gauss<double, 10>;
  constexpr int panels = 40;
  const double slow = relaxation_time(model, after, N), first = std::log(1e-9 * slow), last = std::log(80 * slow);
  motion::RunOptions options;
  options.tolerance = 1e-10;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = after;
  const auto steady = model.law->steady({V, N});
  for (std::size_t k = 0; k < steady.size(); ++k) options.start.states[model.law->states()[k].name] = steady[k];
  std::vector<std::pair<double, double>> nodes;  // time, weight
  for (int panel = 0; panel < panels; ++panel) {
    const double half = 0.5 * (last - first) / panels, middle = first + (2 * panel + 1) * half;
    for (int sign : {-1, 1})
      for (std::size_t k = 0; k < Rule::abscissa().size(); ++k) {
        const double t = std::exp(middle + sign * half * Rule::abscissa()[k]);
        nodes.emplace_back(t, half * Rule::weights()[k] * t);
      }
  }
  std::ranges::sort(nodes);
  for (const auto& [t, weight] : nodes) options.times.push_back(t);
  options.duration = options.times.back();
  const motion::Run relaxation = complete_run(imposed(model, after), options);
  const double residual = model.law->steady_friction({after, N}).friction;
  const auto& mu = relaxation.columns[4];
  double energy = 0;
  for (std::size_t i = 0; i < mu.size(); ++i) energy += nodes[i].second * (mu[i] - residual) * after;
  return energy;
}

double static_peak(const Property& property, const Model& model, double N) {
  const double V = property.slip_rate;
  if (model.law->set_valued()) return model.law->static_limit(N, model.law->rest(N));
  require_states(property, model);
  motion::RunOptions options;
  options.tolerance = 1e-10;
  options.samples = 1;
  options.duration = property.hold;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 0;
  const auto steady = model.law->steady({V, N});
  for (std::size_t k = 0; k < steady.size(); ++k) options.start.states[model.law->states()[k].name] = steady[k];
  const motion::Run hold = complete_run(imposed(model, 0.0), options);
  std::vector<double> state;
  for (std::size_t k = 0; k < steady.size(); ++k) state.push_back(hold.columns[5 + k].back());
  return model.law->friction({V, N}, state);
}

}  // namespace

std::span<const PropertyName> property_names() { return names; }

double value_of(const Property& property, const Model& model) {
  const double V = property.slip_rate, N = model.drive.normal_load.level();
  require(V, {1e-300, 1e6}, "slip_rate", "slip rate of the property", "m/s");
  if (property.name == "steady-friction") return model.law->steady_friction({V, N}).friction;
  if (property.name == "steady-slope") return V * model.law->steady_friction({V, N}).slope;
  if (property.name == "direct-effect") return V * Linearised(model, V, N).slopes.F_u / N;
  if (property.name == "fracture-energy") return fracture_energy(property, model, N);
  if (property.name == "static-peak") return static_peak(property, model, N);
  std::vector<std::string> known;
  for (const auto& p : names) known.emplace_back(p.name);
  const auto near = nearest_name(property.name, known);
  throw InputError(fmt::format("unknown property '{}'{}", property.name,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}

std::vector<Property> steady_curve(double low, double high, int points) {
  std::vector<Property> list;
  for (int i = 0; i < points; ++i)
    list.push_back({.name = "steady-friction", .slip_rate = low * std::pow(high / low, double(i) / (points - 1))});
  return list;
}

namespace {

/// Parameters as coordinates of the search: logarithms where only positive values make sense.
class Coordinates {
 public:
  Coordinates(const Model& model, std::span<const std::string> paths) : paths_(paths.begin(), paths.end()) {
    for (const auto& path : paths_) {
      const auto quantity = model.describe(path);
      ranges_.push_back(quantity.range);
      logarithmic_.push_back(quantity.range.low >= 0 && model.get(path) > 0);
    }
  }
  VectorXd of(const Model& model) const {
    VectorXd q(paths_.size());
    for (std::size_t k = 0; k < paths_.size(); ++k)
      q[k] = logarithmic_[k] ? std::log(model.get(paths_[k])) : model.get(paths_[k]);
    return q;
  }
  Model apply(Model model, const VectorXd& q) const {
    for (std::size_t k = 0; k < paths_.size(); ++k) model = model.with(paths_[k], value(q, k));
    return model;
  }
  double value(const VectorXd& q, std::size_t k) const {
    return std::clamp(logarithmic_[k] ? std::exp(q[k]) : q[k], ranges_[k].low, ranges_[k].high);
  }

 private:
  std::vector<std::string> paths_;
  std::vector<Range> ranges_;
  std::vector<bool> logarithmic_;
};

}  // namespace

Equalised equalise(const Model& member, const Model& reference, std::span<const Property> properties,
                   std::span<const std::string> adjust) {
  if (adjust.size() > properties.size())
    throw InputError(fmt::format("{} parameters cannot be adjusted to {} properties: name fewer, or more properties",
                                 adjust.size(), properties.size()));
  const Coordinates coordinates(member, adjust);
  VectorXd wanted(properties.size());
  for (std::size_t i = 0; i < properties.size(); ++i) wanted[i] = value_of(properties[i], reference);
  const VectorXd scale = wanted.cwiseAbs().cwiseMax(1e-9 * wanted.cwiseAbs().maxCoeff()).cwiseMax(1e-300);
  const auto differences = [&](const VectorXd& q) {
    const Model here = coordinates.apply(member, q);
    VectorXd r(properties.size());
    for (std::size_t i = 0; i < properties.size(); ++i) r[i] = (value_of(properties[i], here) - wanted[i]) / scale[i];
    return r;
  };
  VectorXd q = coordinates.of(member), r = differences(q);
  constexpr double step = 1e-5, agreed = 1e-13;
  double damping = 1e-3;
  for (int iteration = 0; iteration < 200 && r.cwiseAbs().maxCoeff() > agreed; ++iteration) {
    MatrixXd J(r.size(), q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const VectorXd move = step * VectorXd::Unit(q.size(), k);
      J.col(k) = (differences(q + move) - differences(q - move)) / (2 * step);
    }
    const MatrixXd normal = J.transpose() * J;
    const VectorXd gradient = J.transpose() * r;
    bool better = false;
    for (; !better && damping < 1e12; damping *= 10) {
      MatrixXd damped = normal;
      damped.diagonal() += damping * normal.diagonal() + VectorXd::Constant(q.size(), 1e-300);
      VectorXd next = q - damped.ldlt().solve(gradient);
      if (!next.allFinite()) continue;
      VectorXd there;
      try {
        there = differences(next);
      } catch (const InputError&) {  // outside the law's range: a shorter step
        continue;
      }
      if (!(there.squaredNorm() < r.squaredNorm())) continue;
      better = (next - q).norm() > 1e-14 * (1 + q.norm());
      q = next, r = there;
      damping *= 0.01;
      if (!better) break;
    }
    if (!better) break;
  }
  Equalised result{coordinates.apply(member, q), {}, r.cwiseAbs().maxCoeff()};
  for (std::size_t k = 0; k < adjust.size(); ++k) result.values.push_back(coordinates.value(q, k));
  if (adjust.size() == properties.size() && !(result.difference < 1e-6)) {
    std::string reached;
    for (std::size_t k = 0; k < adjust.size(); ++k)
      reached += fmt::format("{}{} = {:.6g}", k > 0 ? ", " : "", adjust[k], result.values[k]);
    throw InputError(
        fmt::format("the properties of '{}' and '{}' cannot be made equal by the parameters named: at {} they still "
                    "differ by {:.2g} (relative); adjust other parameters",
                    member.law->card().name, reference.law->card().name, reached, result.difference));
  }
  return result;
}

}  // namespace rosin::analysis::inference
