/// Least squares on GSL with the slopes of predictions, profiles by repeated fits.
#include "analysis/inference/fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "analysis/response/clipping.hpp"
#include "core/random.hpp"

namespace rosin::analysis::inference {

namespace {

/// A fitted parameter as the variable q = ln p, or p itself where it may be negative.
struct Variable {
  Quantity quantity;
  bool logarithmic;
  double low, high;  ///< of q
  double scale;      ///< of changes in q

  double value(double q) const {
    const double x = std::clamp(q, low, high);
    return std::clamp(logarithmic ? std::exp(x) : x, quantity.range.low, quantity.range.high);
  }
  double of(double p) const { return logarithmic ? std::log(p) : p; }
  /// dp/dq; 0 beyond the bounds.
  double slope(double q) const { return q < low || q > high ? 0 : logarithmic ? value(q) : 1; }
};

Variable make_variable(const Model& model, const std::string& path) {
  require_fittable(model, path);
  Variable v{model.describe(path), false, 0, 0, 1};
  const double value = model.get(path);
  v.logarithmic = v.quantity.range.low >= 0;
  constexpr double smallest = 1e-30, largest = 1e30;
  v.low = v.logarithmic ? std::log(std::max(v.quantity.range.low, smallest)) : v.quantity.range.low;
  v.high = v.logarithmic ? std::log(std::min(v.quantity.range.high, largest)) : v.quantity.range.high;
  v.scale = v.logarithmic ? 1 : std::max(std::abs(value), 1e-6);
  return v;
}

struct Problem {
  const Model* model;
  const std::vector<Measurement>* data;
  std::vector<Variable> variables;
  std::vector<double> q;  ///< all of them; those that are free are replaced
  std::vector<std::size_t> free;
  std::vector<char> used;   ///< points that count; empty: all
  mutable int evaluations;  ///< of the present minimisation

  Model at(const std::vector<double>& all) const {
    Model changed = *model;
    for (std::size_t i = 0; i < variables.size(); ++i)
      changed = changed.with(variables[i].quantity.name, variables[i].value(all[i]));
    return changed;
  }
  /// Standardised residuals, and their slopes by the variables of `moved`, row by row.
  struct Residuals {
    std::vector<double> values, slopes;
  };
  /// Nothing where the model does not answer.
  std::optional<Residuals> residuals(const std::vector<double>& all, const std::vector<std::size_t>& moved = {}) const {
    Residuals r;
    std::vector<std::string> paths;
    for (const auto i : moved) paths.push_back(variables[i].quantity.name);
    try {
      const Model changed = at(all);
      std::size_t point = 0;
      for (const auto& m : *data) {
        const auto predicted = predict(changed, m, paths);
        for (std::size_t k = 0; k < predicted.y.size(); ++k, ++point) {
          const double weight = (used.empty() || used[point] ? 1 : 0) / m.error[k];
          r.values.push_back(weight * (predicted.y[k] - m.y[k]));
          for (std::size_t j = 0; j < moved.size(); ++j)
            r.slopes.push_back(weight * predicted.slopes[j][k] * variables[moved[j]].slope(all[moved[j]]));
        }
      }
    } catch (const InputError&) {
      return std::nullopt;
    }
    // Beyond a bound the model stands still: a slope leads back.
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const auto& v = variables[i];
      const double beyond = all[i] - std::clamp(all[i], v.low, v.high), steep = 1e3 / v.scale;
      r.values.push_back(steep * beyond);
      for (const auto j : moved) r.slopes.push_back(j == i && beyond != 0 ? steep : 0);
    }
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!std::ranges::all_of(r.values, finite) || !std::ranges::all_of(r.slopes, finite)) return std::nullopt;
    return r;
  }
  std::vector<double> with_free(const gsl_vector* x) const {
    auto all = q;
    for (std::size_t i = 0; i < free.size(); ++i) all[free[i]] = gsl_vector_get(x, i);
    return all;
  }
  std::size_t rows() const {
    std::size_t n = variables.size();
    for (const auto& m : *data) n += m.y.size();
    return n;
  }
};

constexpr double refused = 1e8;        ///< residual where the model does not answer
constexpr int most_evaluations = 500;  ///< of one minimisation; those that converge take some tens

int residual_callback(const gsl_vector* x, void* context, gsl_vector* f) {
  const auto& problem = *static_cast<const Problem*>(context);
  if (++problem.evaluations > most_evaluations) return GSL_EMAXITER;
  const auto r = problem.residuals(problem.with_free(x));
  for (std::size_t i = 0; i < f->size; ++i) gsl_vector_set(f, i, r ? r->values[i] : refused);
  return GSL_SUCCESS;
}

int jacobian_callback(const gsl_vector* x, void* context, gsl_matrix* J) {
  const auto& problem = *static_cast<const Problem*>(context);
  const auto r = problem.residuals(problem.with_free(x), problem.free);
  for (std::size_t i = 0; i < J->size1; ++i)
    for (std::size_t j = 0; j < J->size2; ++j) gsl_matrix_set(J, i, j, r ? r->slopes[i * J->size2 + j] : 0);
  return GSL_SUCCESS;
}

struct Minimum {
  std::vector<double> q;
  double chi_square = infinity;
  std::vector<double> covariance;  ///< of the free variables
  bool converged = false;
};

Minimum minimise(Problem& problem) {
  Minimum best{problem.q, infinity, {}, false};
  problem.evaluations = 0;
  const std::size_t n = problem.rows(), p = problem.free.size();
  if (p == 0) {
    if (const auto r = problem.residuals(problem.q)) {
      best.chi_square = 0;
      for (const double x : r->values) best.chi_square += x * x;
      best.converged = true;
    }
    return best;
  }
  if (!problem.residuals(problem.q)) return best;
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf fdf{residual_callback, jacobian_callback, nullptr, n, p, &problem, 0, 0, 0};
  std::unique_ptr<gsl_multifit_nlinear_workspace, decltype(&gsl_multifit_nlinear_free)> work(
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n, p), gsl_multifit_nlinear_free);
  std::vector<double> start(p);
  for (std::size_t i = 0; i < p; ++i) start[i] = problem.q[problem.free[i]];
  const auto x = gsl_vector_view_array(start.data(), p);
  if (gsl_multifit_nlinear_init(&x.vector, &fdf, work.get()) != GSL_SUCCESS) return best;
  int info = 0;
  const int status = gsl_multifit_nlinear_driver(200, 1e-10, 1e-10, 0, nullptr, nullptr, &info, work.get());
  best.q = problem.with_free(gsl_multifit_nlinear_position(work.get()));
  const auto* f = gsl_multifit_nlinear_residual(work.get());
  best.chi_square = 0;
  for (std::size_t i = 0; i < n; ++i) best.chi_square += std::pow(gsl_vector_get(f, i), 2);
  best.converged = status == GSL_SUCCESS || status == GSL_ENOPROG;  // no progress: at the rounding of the predictions
  best.covariance.resize(p * p);
  auto covariance = gsl_matrix_view_array(best.covariance.data(), p, p);
  gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work.get()), 0, &covariance.matrix);
  return best;
}

/// Two-sided quantile of the normal distribution by Newton's method on erf.
double normal_quantile(double confidence) {
  double z = 1;
  for (int i = 0; i < 60; ++i)
    z -= (std::erf(z / std::numbers::sqrt2) - confidence) / (std::sqrt(2 / std::numbers::pi) * std::exp(-z * z / 2));
  return z;
}

/// The q of one variable on one side at which χ² has risen by z²: secants on its root, which is nearly straight.
double profile_end(Problem problem, const Minimum& best, std::size_t index, double step, double z) {
  const auto& variable = problem.variables[index];
  std::erase(problem.free, index);
  problem.q = best.q;
  double inner = best.q[index], inner_height = 0, outer = inner + step;
  bool flat = false;
  for (int i = 0; i < 12; ++i) {
    const double q = std::clamp(outer, variable.low, variable.high);
    problem.q[index] = q;
    const auto there = minimise(problem);
    const double height = std::sqrt(std::max(0.0, there.chi_square - best.chi_square));
    if (!std::isfinite(height)) return q;
    if (std::abs(height - z) < 1e-3 * z) return q;
    if (q != outer && height < z) return q;  // the bound
    problem.q = there.q;
    const double slope = (height - inner_height) / (q - inner);
    flat = std::abs(slope) * std::abs(step) < 1e-3;
    if (flat) {  // it may rise farther out
      inner = q, inner_height = height, outer = q + (step *= 3);
      continue;
    }
    const double next = q + std::clamp((z - height) / slope / std::abs(step), -3.0, 3.0) * std::abs(step);
    inner = q, inner_height = height, outer = next;
  }
  return flat ? (step > 0 ? variable.high : variable.low) : outer;
}

}  // namespace

void require_fittable(const Model& model, const std::string& path) {
  const auto quantity = model.describe(path);
  const double value = model.get(path);
  if (!path.starts_with("law."))
    throw InputError(
        fmt::format("{}: a fit finds numbers of the law and its contact, law.…; measurements have their own drive, and "
                    "none of them knows a slider",
                    path));
  if (!std::isfinite(value) || (quantity.range.low >= 0 && !(value > 0)))
    throw InputError(fmt::format("{} = {}: a fit needs a start above 0 and finite", path, value));
}

Fit fit(const Model& model, const std::vector<Measurement>& data, const FitOptions& options) {
  gsl_set_error_handler_off();
  Problem problem{&model, &data, {}, {}, {}, {}, 0};
  for (const auto& path : options.parameters) {
    problem.variables.push_back(make_variable(model, path));
    problem.q.push_back(problem.variables.back().of(model.get(path)));
    problem.free.push_back(problem.free.size());
  }
  const std::size_t p = problem.free.size();
  Fit result;
  for (const auto& m : data) {
    const bool pairs = m.kind == Measurement::Kind::frequency_response;
    if (m.y.size() != m.x.size() * (pairs ? 2 : 1) || m.error.size() != m.y.size())
      throw InputError(fmt::format("{}: as many values and errors as points are needed", m.name));
    if (!std::ranges::all_of(m.error, [](double e) { return e > 0 && std::isfinite(e); }))
      throw InputError(fmt::format("{}: standard errors must be above 0 and finite", m.name));
    if (m.kind != Measurement::Kind::steady_curve && !std::ranges::is_sorted(m.x))
      throw InputError(fmt::format("{}: its abscissae must ascend", m.name));
    result.points += int(m.y.size());
    if (!pairs) {
      response::ClippingWatch watch;
      for (const double y : m.y) watch.add(y);
      if (auto clipped = response::clipping_warning(watch, m.name + ": friction", "1", long(m.y.size()));
          !clipped.empty())
        result.warnings.push_back(std::move(clipped));
    }
  }
  if (p == 0) throw InputError("a fit needs parameters");
  if (std::size_t(result.points) <= p)
    throw InputError(fmt::format("{} numbers do not determine {} parameters", result.points, p));

  const int starts = std::max(1, options.starts), folds = options.folds > 1 ? options.folds : 0;
  const int total = starts + (options.profiles ? 2 * int(p) : 0) + folds;
  auto report = [&, done = 0]() mutable {
    if (options.progress) options.progress(++done, total);
  };
  const auto own = problem.q;
  const auto random = white_noise(p * std::size_t(starts), options.seed);
  Minimum best;
  for (int s = 0; s < starts; ++s) {
    problem.q = own;
    const double spread = std::log(30.0) / 2;
    for (std::size_t i = 0; s > 0 && i < p; ++i) {
      const auto& v = problem.variables[i];
      problem.q[i] = std::clamp(own[i] + spread * v.scale * random[std::size_t(s) * p + i], v.low, v.high);
    }
    auto found = minimise(problem);
    report();
    if (!std::isfinite(found.chi_square)) continue;
    result.converged_starts += found.converged;
    if (found.chi_square < best.chi_square) best = std::move(found);
  }
  if (!std::isfinite(best.chi_square))
    throw InputError("the model answers to none of the starts: its parameters do not allow this prediction");
  if (!best.converged)
    result.outcome = {
        Ending::budget_spent,
        fmt::format("the least squares did not converge from any of {} starts, within {} evaluations each", starts,
                    most_evaluations)};

  problem.q = best.q;
  result.model = problem.at(best.q);
  result.chi_square = best.chi_square;
  result.aic = best.chi_square + 2 * double(p);
  result.bic = best.chi_square + double(p) * std::log(double(result.points));
  const double z = normal_quantile(options.confidence);
  const auto at_best = problem.residuals(best.q, problem.free);
  if (!at_best) {
    result.outcome = {Ending::not_finite, "predictions at the least squares, or their slopes, are not finite"};
    return result;
  }
  for (std::size_t i = 0; i < p; ++i) {
    const auto& v = problem.variables[i];
    double influence = 0;  // standard errors of the data per change of q by its scale
    for (int k = 0; k < result.points; ++k)
      influence = std::hypot(influence, at_best->slopes[std::size_t(k) * p + i] * v.scale);
    const double spread = std::sqrt(best.covariance[i * p + i]);
    FittedParameter parameter{v.quantity.name, v.quantity.unit, v.value(best.q[i])};
    parameter.standard_error = spread * (v.logarithmic ? parameter.value : 1);
    parameter.low = v.value(best.q[i] - z * spread), parameter.high = v.value(best.q[i] + z * spread);
    parameter.at_bound = best.q[i] <= v.low + 1e-6 * v.scale || best.q[i] >= v.high - 1e-6 * v.scale;
    parameter.profile_low = parameter.profile_high = std::nan("");
    double profile_low = v.low, profile_high = v.high;  // q
    if (options.profiles && spread > 0 && std::isfinite(spread)) {
      const double first = std::min(z * spread, 3 * v.scale);
      profile_low = profile_end(problem, best, i, -first, z);
      report();
      profile_high = profile_end(problem, best, i, first, z);
      report();
      parameter.profile_low = v.value(profile_low), parameter.profile_high = v.value(profile_high);
    }
    // A number that no prediction hangs on, and one whose interval is wider than all that it may be, is not found; its
    // profile may still bound it on one side, as that of a spring too stiff to show.
    constexpr double none = 1e-6;
    const bool silent = influence < none, wide = !(z * spread < v.high - v.low);
    if (!parameter.at_bound && (silent || wide)) {
      const bool bounded = profile_low > v.low || profile_high < v.high;
      parameter.standard_error = parameter.low = parameter.high = std::nan("");
      result.warnings.push_back(
          bounded  ? fmt::format("the data bound {} on one side only: {:.3g} … {:.3g} by its profile", parameter.path,
                                 parameter.profile_low, parameter.profile_high)
          : silent ? fmt::format("the data do not depend on {}: {:.6g} is where the fit left it, without an interval",
                                 parameter.path, parameter.value)
                   : fmt::format("the data do not determine {}: its interval would be wider than its range, {}",
                                 parameter.path, text(v.quantity.range)));
      if (!bounded) {
        parameter.profile_low = parameter.profile_high = std::nan("");
        if (result.outcome.complete()) result.outcome = {Ending::none_exists, result.warnings.back()};
      }
    }
    if (parameter.at_bound)
      result.warnings.push_back(
          fmt::format("{} = {:.6g} lies at an end of its range", parameter.path, parameter.value));
    else if (!std::isnan(parameter.low) && v.logarithmic && spread > 1)
      result.warnings.push_back(fmt::format("{} is hardly determined: a factor of {:.2g} is within one standard error",
                                            parameter.path, std::exp(spread)));
    result.parameters.push_back(parameter);
    for (std::size_t j = 0; j < p; ++j) {
      const double product = best.covariance[i * p + i] * best.covariance[j * p + j];
      result.correlation.push_back(product > 0 ? best.covariance[i * p + j] / std::sqrt(product) : std::nan(""));
      if (j < i && std::abs(result.correlation.back()) > 0.99)
        result.warnings.push_back(fmt::format("{} and {} are told apart poorly: correlation {:.4f}",
                                              options.parameters[j], options.parameters[i], result.correlation.back()));
    }
  }
  const double expected = double(result.points) - double(p);
  if (best.chi_square > expected + 4 * std::sqrt(2 * expected))
    result.warnings.push_back(fmt::format(
        "chi square is {:.4g} where {:.4g} is expected: the law does not describe these data, or their errors are "
        "larger than stated; intervals are too narrow",
        best.chi_square, expected));
  const auto& residuals = at_best->values;
  std::size_t point = 0;
  for (const auto& m : data) {
    result.residuals.emplace_back(residuals.begin() + std::ptrdiff_t(point),
                                  residuals.begin() + std::ptrdiff_t(point + m.y.size()));
    point += m.y.size();
  }

  result.cross_validation = std::nan("");
  if (options.folds > 1) {
    double sum = 0;
    for (int fold = 0; fold < options.folds; ++fold) {  // both parts of a response stay together
      problem.used.assign(std::size_t(result.points), 1);
      std::size_t index = 0;
      for (const auto& m : data) {
        const std::size_t together = m.kind == Measurement::Kind::frequency_response ? 2 : 1;
        for (std::size_t i = 0; i < m.y.size(); ++i) problem.used[index++] = int(i / together) % options.folds != fold;
      }
      problem.q = best.q;
      const auto trained = minimise(problem);
      report();
      const auto left_out = problem.used;
      problem.used.clear();
      const auto all = problem.residuals(trained.q);
      for (std::size_t i = 0; i < left_out.size(); ++i)
        if (!left_out[i]) sum += all ? all->values[i] * all->values[i] : infinity;
    }
    result.cross_validation = sum / result.points;
  }
  return result;
}

}  // namespace rosin::analysis::inference
