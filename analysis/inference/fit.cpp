/// Least squares on GSL with the slopes of predictions, noise found in turn with them, profiles by repeated fits.
#include "analysis/inference/fit.hpp"

#include <fmt/format.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "analysis/response/clipping.hpp"
#include "core/random.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::inference {

namespace {

/// A fitted parameter as the variable q = ln p, or p itself where it may be negative.
struct Variable {
  enum class Term { none, base, trend, clock_offset };
  Quantity quantity;
  bool logarithmic;
  double low, high;  ///< of q
  double scale;      ///< of changes in q
  Term term = Term::none;
  std::size_t measurement = 0;  ///< that the term belongs to

  double value(double q) const {
    const double x = std::clamp(q, low, high);
    return std::clamp(logarithmic ? std::exp(x) : x, quantity.range.low, quantity.range.high);
  }
  double of(double p) const { return logarithmic ? std::log(p) : p; }
  /// dp/dq; 0 beyond the bounds.
  double slope(double q) const { return q < low || q > high ? 0 : logarithmic ? value(q) : 1; }
};

Variable make_variable(const Subject& subject, const std::string& path) {
  require_fittable(subject, path, true);
  Variable v{subject.describe(path), false, 0, 0, 1};
  const double value = subject.get(path);
  v.logarithmic = v.quantity.range.low >= 0;
  constexpr double smallest = 1e-30, largest = 1e30;
  v.low = v.logarithmic ? std::log(std::max(v.quantity.range.low, smallest)) : v.quantity.range.low;
  v.high = v.logarithmic ? std::log(std::min(v.quantity.range.high, largest)) : v.quantity.range.high;
  v.scale = v.logarithmic ? 1 : std::max(std::abs(value), 1e-6);
  return v;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double x : values) most = std::max(most, std::abs(x));
  return most;
}

/// The terms of a measurement's laboratory; each begins at 0.
/// \param has_clock  a column of the same motion has said how late its clock is
void add_terms(std::vector<Variable>& variables, const Measurement& m, std::size_t index, bool has_clock) {
  using Trend = Measurement::Terms::Trend;
  using Term = Variable::Term;
  const auto add = [&](Term term, const char* name, std::string unit, double scale, double most, const char* meaning) {
    const Quantity quantity{fmt::format("data.{}.{}", index + 1, name), std::move(unit), {-most, most}, meaning};
    variables.push_back({quantity, false, -most, most, scale, term, index});
  };
  const bool over_way = m.over == Measurement::Over::displacement;
  const std::string unit = m.unit_of_y();
  const double size = largest(m.y) > 0 ? largest(m.y) : 1;
  constexpr double wide = 100;  // times all of y
  if (m.terms.base) add(Term::base, "base", unit, size, wide * size, "level beside the law's friction");
  if (m.terms.trend != Trend::none) {
    const double reach = largest(trend_abscissa(m));
    if (!(reach > 0)) throw InputError(fmt::format("{}: its points leave no room for a trend", m.name));
    const char* per = m.terms.trend == Trend::time ? "s" : "m";
    add(Term::trend, "trend", fmt::format("{}/{}", unit, per), size / reach, wide * size / reach,
        "straight line beside the law's friction");
  }
  if (m.terms.clock_offset && !has_clock) {
    const double span = m.x.back() - m.x.front();
    if (!(span > 0)) throw InputError(fmt::format("{}: one time alone tells of no clock offset", m.name));
    add(Term::clock_offset, "clock_offset", over_way ? "m" : "s", span / 100, span,
        "by so much later the motion took place");
  }
}

/// By how much a standardised residual exceeds what noise does to a force at its limit.
double beyond_noise(double residual) {
  constexpr double noise = 4;  // standard deviations, that a force stays below among ten thousands
  return residual > noise ? residual - noise : residual < -noise ? residual + noise : 0;
}

struct Problem {
  const Subject* subject;
  const std::vector<Measurement>* data;
  std::vector<Variable> variables;
  std::vector<double> q;  ///< all of them; those that are free are replaced
  std::vector<std::size_t> free;
  std::vector<char> used;                   ///< points that count; empty: all
  std::vector<SeriesNoise> noise;           ///< of each measurement; of size 1 where errors are given
  std::vector<std::vector<double>> trends;  ///< of each measurement: what its trend is multiplied by
  std::vector<std::vector<char>> shadows;   ///< of each measurement: points that are left out; empty: none
  mutable int evaluations;                  ///< of the present minimisation
  mutable long predictions = 0, steps = 0;  ///< in all

  Subject at(const std::vector<double>& all) const {
    Subject changed = *subject;
    for (std::size_t i = 0; i < variables.size(); ++i)
      if (variables[i].term == Variable::Term::none)
        changed = changed.with(variables[i].quantity.name, variables[i].value(all[i]));
    return changed;
  }
  double error(std::size_t measurement, std::size_t point) const {
    const auto& m = (*data)[measurement];
    return m.error.empty() ? noise[measurement].size : m.error[point];
  }
  bool in_shadow(std::size_t measurement, std::size_t point) const {
    return !shadows[measurement].empty() && shadows[measurement][point];
  }
  /// True for a term of this measurement's laboratory. Columns of one motion share a clock.
  bool belongs(const Variable& v, std::size_t measurement) const {
    if (v.term == Variable::Term::none || v.measurement == measurement) return v.term != Variable::Term::none;
    const auto &one = (*data)[v.measurement], &other = (*data)[measurement];
    return v.term == Variable::Term::clock_offset && one.kind == Measurement::Kind::motion &&
           other.kind == Measurement::Kind::motion && one.machine == other.machine;
  }
  /// y of one measurement, and its slopes by the variables of `moved`, a row of them for each point.
  struct Said {
    std::vector<double> y, slopes;
    std::vector<char> bounded;      ///< as of a prediction
    std::vector<double> slip_rate;  ///< as of a prediction
  };
  Said predicted(const Subject& changed, std::size_t measurement, const std::vector<double>& all,
                 const std::vector<std::size_t>& moved) const {
    using Term = Variable::Term;
    const auto& m = (*data)[measurement];
    std::vector<std::string> paths;
    for (const auto i : moved)
      if (variables[i].term == Term::none) paths.push_back(variables[i].quantity.name);
    double base = 0, trend = 0, clock_offset = 0;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (!belongs(variables[i], measurement)) continue;
      const double value = variables[i].value(all[i]);
      if (variables[i].term == Term::base) base = value;
      if (variables[i].term == Term::trend) trend = value;
      if (variables[i].term == Term::clock_offset) clock_offset = value;
    }
    auto prediction = predict(changed, m, paths, clock_offset);
    ++predictions, steps += prediction.steps;
    Said said{std::move(prediction.y), {}, std::move(prediction.bounded), std::move(prediction.slip_rate)};
    said.bounded.resize(said.y.size());
    const auto& s = trends[measurement];
    for (std::size_t k = 0; k < said.y.size(); ++k) {
      const double beside = base + (s.empty() ? 0 : trend * s[k]), limit = said.y[k], force = m.y[k] - beside;
      // Friction at rest is the measured one as far as it lies within its limit.
      if (said.bounded[k]) said.y[k] = std::clamp(force, -limit, limit);
      const double side = !said.bounded[k] ? 1 : force > limit ? 1 : force < -limit ? -1 : 0;
      said.y[k] += beside;
      std::size_t path = 0;
      for (const auto i : moved) {
        const auto& v = variables[i];
        double slope = 0;
        if (v.term == Term::none)
          slope = side * prediction.slopes[path++][k];
        else if (belongs(v, measurement))
          slope = v.term == Term::base ? 1 : v.term == Term::trend ? s[k] : prediction.by_clock[k];
        said.slopes.push_back(slope * v.slope(all[i]));
      }
    }
    return said;
  }
  /// Standardised residuals, as independent as their noise is known to be, and their slopes by the variables of
  /// `moved`, row by row.
  struct Residuals {
    std::vector<double> values, slopes;
  };
  /// Nothing where the model does not answer.
  std::optional<Residuals> residuals(const std::vector<double>& all, const std::vector<std::size_t>& moved = {}) const {
    Residuals r;
    try {
      const Subject changed = at(all);
      std::size_t point = 0;
      for (std::size_t d = 0; d < data->size(); ++d) {
        const auto& m = (*data)[d];
        auto said = predicted(changed, d, all, moved);
        for (std::size_t k = 0; k < said.y.size(); ++k, ++point) {
          said.y[k] = (said.y[k] - m.y[k]) / error(d, k);
          if (said.bounded[k]) said.y[k] = beyond_noise(said.y[k]);
          const bool out = in_shadow(d, k) || (!used.empty() && !used[point]);
          if (out) said.y[k] = 0;
          const bool idle = out || (said.bounded[k] && said.y[k] == 0);
          for (std::size_t j = 0; j < moved.size(); ++j)
            said.slopes[k * moved.size() + j] *= idle ? 0 : 1 / error(d, k);
          said.bounded[k] = said.bounded[k] || out;
        }
        whiten(said.y, 1, noise[d].correlation, said.bounded);
        whiten(said.slopes, moved.size(), noise[d].correlation, said.bounded);
        r.values.insert(r.values.end(), said.y.begin(), said.y.end());
        r.slopes.insert(r.slopes.end(), said.slopes.begin(), said.slopes.end());
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
  bool errors_given() const {
    return std::ranges::none_of(*data, [](const auto& m) { return m.error.empty(); });
  }
  /// y of all measurements.
  std::size_t numbers() const {
    std::size_t n = 0;
    for (const auto& m : *data) n += m.y.size();
    return n;
  }
  std::size_t rows() const { return numbers() + variables.size(); }
  /// True of each number that does not count: bounded and not predicted, or left out.
  std::vector<char> apart(const std::vector<double>& all) const {
    std::vector<char> some;
    for (std::size_t d = 0; d < data->size(); ++d) {
      const auto bounded = predicted(at(all), d, all, {}).bounded;
      for (std::size_t k = 0; k < bounded.size(); ++k) some.push_back(bounded[k] || in_shadow(d, k));
    }
    return some;
  }
};

constexpr double refused = 1e8;        ///< residual where the model does not answer
constexpr int most_evaluations = 500;  ///< of one minimisation; those that converge take some tens

int residual_callback(const gsl_vector* x, void* context, gsl_vector* f) {
  const auto& problem = *static_cast<const Problem*>(context);
  if (++problem.evaluations > most_evaluations || Listening::stop_asked()) return GSL_EMAXITER;
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

/// How far least squares are from their minimum, in standard errors of the parameters: root mean square of the residual
/// along the slopes, over that across them (relative offset: Bates & Watts 1981, Technometrics 23, 179).
double relative_offset(const gsl_vector& f, const gsl_matrix& J) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto n = Eigen::Index(J.size1), p = Eigen::Index(J.size2);
  const Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>> slopes(J.data, n, p,
                                                                   Eigen::OuterStride<>(Eigen::Index(J.tda)));
  const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>> residual(
      f.data, n, Eigen::InnerStride<>(Eigen::Index(f.stride)));
  Eigen::VectorXd across = residual;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(slopes);
  across.applyOnTheLeft(qr.householderQ().adjoint());
  const auto rank = qr.rank();
  return std::sqrt(across.head(rank).squaredNorm() / double(rank) /
                   (across.tail(n - rank).squaredNorm() / double(n - rank)));
}

constexpr double near = 1e-6;        ///< relative offset at which a minimum is found
constexpr double near_enough = 0.1;  ///< and at which it is known which of several starts leads to the lowest

Minimum minimise(Problem& problem, double offset = near) {
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
  const auto found = [&] {
    return relative_offset(*gsl_multifit_nlinear_residual(work.get()), *gsl_multifit_nlinear_jac(work.get())) < offset;
  };
  // A start that is to be told from others ends where ten steps gain less than a tenth of a standard error: it follows
  // a valley that leads nowhere.
  constexpr std::size_t together = 10;
  constexpr double gain = 0.01;  // of the mean square
  std::vector<double> squares;
  const auto in_valley = [&] {
    const double norm = gsl_blas_dnrm2(gsl_multifit_nlinear_residual(work.get())), square = norm * norm;
    squares.push_back(square);
    return offset > near && squares.size() > together &&
           squares[squares.size() - 1 - together] - square < gain * square / double(n - p);
  };
  int status = found() ? GSL_SUCCESS : GSL_CONTINUE, info = 0;
  constexpr int most_iterations = 200;
  for (int i = 0; i < most_iterations && status == GSL_CONTINUE; ++i) {
    const int step = gsl_multifit_nlinear_iterate(work.get());
    if (step == GSL_EMAXITER || (step == GSL_ENOPROG && i == 0)) break;  // later it tries again with shorter steps
    status = found() ? GSL_SUCCESS : gsl_multifit_nlinear_test(1e-10, 1e-10, 0, &info, work.get());
    if (status == GSL_CONTINUE && in_valley()) break;
  }
  end_if_stopped();
  best.q = problem.with_free(gsl_multifit_nlinear_position(work.get()));
  best.chi_square = std::pow(gsl_blas_dnrm2(gsl_multifit_nlinear_residual(work.get())), 2);
  // Tolerances below rounding: at the rounding of the predictions.
  best.converged = status == GSL_SUCCESS || status == GSL_ETOLF || status == GSL_ETOLX || status == GSL_ETOLG;
  best.covariance.resize(p * p);
  auto covariance = gsl_matrix_view_array(best.covariance.data(), p, p);
  gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work.get()), 0, &covariance.matrix);
  return best;
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

void require_fittable(const Subject& subject, const std::string& path, bool with_slider) {
  const auto quantity = subject.describe(path);
  const double value = subject.get(path);
  if (subject.machines.empty() && (path.starts_with("oscillator.") ? !with_slider : !path.starts_with("law.")))
    throw InputError(
        fmt::format("{}: a fit finds numbers of the law and its contact, law.…, of the slider, oscillator.…, where "
                    "events of stick-slip are among the data, and of any machine whose motion is; other measurements "
                    "have their own drive",
                    path));
  if (!std::isfinite(value) || (quantity.range.low >= 0 && !(value > 0)))
    throw InputError(fmt::format("{} = {}: a fit needs a start above 0 and finite", path, value));
}

namespace {

void check(const Measurement& m) {
  if (m.x.empty()) throw InputError(fmt::format("{}: holds no point", m.name));
  const bool known = !m.error.empty();
  if (m.y.size() != m.x.size() * (m.pairs() ? 2 : 1) || (known && m.error.size() != m.y.size()))
    throw InputError(fmt::format("{}: as many values and errors as points are needed", m.name));
  if (!std::ranges::all_of(m.error, [](double e) { return e > 0 && std::isfinite(e); }))
    throw InputError(fmt::format("{}: standard errors must be above 0 and finite", m.name));
  const bool any_order = m.kind == Measurement::Kind::steady_curve || m.kind == Measurement::Kind::stick_slip;
  if (!any_order && !std::ranges::is_sorted(m.x))
    throw InputError(fmt::format("{}: its abscissae must ascend", m.name));
  if (m.kind == Measurement::Kind::velocity_step && m.x.back() < m.step_at)
    throw InputError(fmt::format("{}: every point lies before the step at {:.6g} {}: its transient is not in the data",
                                 m.name, m.step_at, m.over == Measurement::Over::time ? "s" : "m"));
}

/// Residuals of each measurement and their slopes, over the errors where these are given.
std::vector<Leftover> leftovers(const Problem& problem, const std::vector<double>& q) {
  const auto& moved = problem.free;
  std::vector<Leftover> parts;
  const auto model = problem.at(q);
  for (std::size_t d = 0; d < problem.data->size(); ++d) {
    const auto& m = (*problem.data)[d];
    auto said = problem.predicted(model, d, q, moved);
    Leftover part{std::move(said.y), std::move(said.slopes), problem.noise[d], m.error.empty(),
                  m.series(),        std::move(said.bounded)};
    for (std::size_t k = 0; k < part.residual.size(); ++k) {
      part.apart[k] = part.apart[k] || problem.in_shadow(d, k);
      const double unit = part.unknown ? 1 : m.error[k];
      part.residual[k] = (part.residual[k] - m.y[k]) / unit;
      for (std::size_t j = 0; j < moved.size(); ++j) part.slopes[k * moved.size() + j] /= unit;
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

/// Finds the noise whose size is not given, from what the minimum leaves. \returns the largest change of it.
double find_noise_at(Problem& problem, const Minimum& best) {
  auto parts = leftovers(problem, best.q);
  find_noise(parts);
  double changed = 0;
  for (std::size_t d = 0; d < parts.size(); ++d) {
    const auto& now = parts[d].noise;
    changed = std::max({changed, std::abs(now.size / problem.noise[d].size - 1),
                        std::abs(now.correlation - problem.noise[d].correlation)});
    problem.noise[d] = now;
  }
  return changed;
}

/// Finds the points behind missing rows whose friction hangs on what happened meanwhile: which differs there by more
/// than a third of the noise, or at the point before. \returns true if they are others than before.
bool find_shadows(Problem& problem, const std::vector<double>& q) {
  const auto model = problem.at(q);
  bool changed = false;
  for (std::size_t d = 0; d < problem.data->size(); ++d) {
    const auto& m = (*problem.data)[d];
    if (m.history.gaps.empty() || !m.history.smooth()) continue;
    std::vector<char> shadow(m.y.size(), 0);
    const auto own = predict(model, m).y;
    for (const bool as_behind : {false, true}) {
      auto other = m;
      other.history = m.history.across(as_behind);
      const auto there = predict(model, other).y;
      constexpr double part = 1.0 / 3;
      for (std::size_t k = 0; k < shadow.size(); ++k)
        if (std::abs(there[k] - own[k]) > part * problem.error(d, k))
          for (std::size_t next = k; next < std::min(k + 2, shadow.size()); ++next) shadow[next] = 1;
    }
    changed = changed || shadow != problem.shadows[d];
    problem.shadows[d] = std::move(shadow);
  }
  return changed;
}

/// Friction has a corner where a step begins, which the offset of a clock moves from point to point: its slope at one
/// offset tells little of the others within its error. The covariance takes the secant over that error instead.
void take_secants(const Problem& problem, Minimum& best, Problem::Residuals& at_best) {
  const std::size_t p = problem.free.size(), rows = at_best.values.size();
  constexpr int rounds = 3;  // the error follows from the secant over it
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < p; ++i) {
      const auto& v = problem.variables[i];
      if (v.term != Variable::Term::clock_offset) continue;
      const double step = std::min(std::sqrt(best.covariance[i * p + i]), v.high / 10);
      if (!(step > 0)) continue;
      auto low = best.q, high = best.q;
      low[i] -= step, high[i] += step;
      const auto before = problem.residuals(low), after = problem.residuals(high);
      if (!before || !after) continue;
      for (std::size_t k = 0; k < rows; ++k)
        at_best.slopes[k * p + i] = (after->values[k] - before->values[k]) / (2 * step);
      const auto J = gsl_matrix_const_view_array(at_best.slopes.data(), rows, p);
      auto covariance = gsl_matrix_view_array(best.covariance.data(), p, p);
      gsl_multifit_nlinear_covar(&J.matrix, 0, &covariance.matrix);
    }
}

/// A record whose motion is known with errors of its own.
bool moves(const Measurement& m) { return m.kind == Measurement::Kind::record && m.history.smooth(); }

/// Root mean square by which predictions differ under other motions that a record allows as well, in the data's unit.
double left_open_by_motion(const Problem& problem, const std::vector<double>& q, std::size_t measurement) {
  constexpr std::uint64_t draws = 4;
  const auto& m = (*problem.data)[measurement];
  if (!moves(m)) return 0;
  const auto model = problem.at(q);
  const auto own = predict(model, m).y;
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    auto other = m;
    other.history = m.history.again(seed);
    const auto there = predict(model, other).y;
    for (std::size_t k = 0; k < own.size(); ++k)
      if (!problem.in_shadow(measurement, k)) sum += std::pow(there[k] - own[k], 2);
  }
  return std::sqrt(sum / double(draws * own.size()));
}

/// Counts in the errors that motions are known with errors of their own: each number follows predictions under other
/// motions that the records allow as well. \returns their part of each variance.
std::vector<double> count_motions(const Problem& problem, Minimum& best, const Problem::Residuals& at_best) {
  constexpr std::uint64_t draws = 16;
  const auto p = Eigen::Index(problem.free.size()), rows = Eigen::Index(at_best.values.size());
  std::vector<double> part(std::size_t(p), 0.0);
  if (p == 0 || std::ranges::none_of(*problem.data, moves)) return part;
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
      at_best.slopes.data(), rows, p);
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Covariance> covariance(best.covariance.data(), p, p);
  const Covariance own = covariance;
  Covariance of_motions = Covariance::Zero(p, p);
  int counted = 0;
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    auto data = *problem.data;
    for (auto& m : data)
      if (moves(m)) m.history = m.history.again(seed);
    auto moved = problem;
    moved.data = &data;
    const auto there = moved.residuals(best.q);
    problem.predictions = moved.predictions, problem.steps = moved.steps;
    if (!there) continue;
    Eigen::VectorXd change(rows);
    for (Eigen::Index i = 0; i < rows; ++i) change[i] = there->values[std::size_t(i)] - at_best.values[std::size_t(i)];
    const Eigen::VectorXd shift = own * (J.transpose() * change);
    of_motions += shift * shift.transpose();
    ++counted;
  }
  if (counted == 0) return part;
  covariance += of_motions / counted;
  for (Eigen::Index i = 0; i < p; ++i) part[std::size_t(i)] = of_motions(i, i) / counted;
  return part;
}

/// What a trend over time is multiplied by.
std::vector<double> trend_over_time(Measurement m) {
  m.terms.trend = Measurement::Terms::Trend::time;
  return trend_abscissa(m);
}

/// What another term would find in a series.
struct Found {
  double fall = 0;   ///< of χ², by the slopes at the minimum
  double value = 0;  ///< of the term
};
/// \param slope of the series by the term, at each x
/// \param apart points that do not count
Found another_term(const Problem& problem, const Problem::Residuals& at_best, std::size_t measurement,
                   std::size_t first_row, std::vector<double> slope, const std::vector<char>& apart) {
  for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = apart[k] ? 0 : slope[k] / problem.error(measurement, k);
  whiten(slope, 1, problem.noise[measurement].correlation, apart);
  const auto p = Eigen::Index(problem.free.size()), rows = Eigen::Index(at_best.values.size());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
      at_best.slopes.data(), rows, p);
  const Eigen::Map<const Eigen::VectorXd> r(at_best.values.data(), rows);
  Eigen::VectorXd column = Eigen::VectorXd::Zero(rows);
  for (std::size_t k = 0; k < slope.size(); ++k) column[Eigen::Index(first_row + k)] = slope[k];
  Eigen::MatrixXd scaled = J;
  for (Eigen::Index j = 0; j < p; ++j)
    if (const double size = scaled.col(j).norm(); size > 0) scaled.col(j) /= size;
  const Eigen::VectorXd own = column - scaled * scaled.completeOrthogonalDecomposition().solve(column);
  const double square = own.squaredNorm(), product = own.dot(r);
  return square > 1e-12 * column.squaredNorm() ? Found{product * product / square, -product / square} : Found{};
}

/// The parts of a fit that look at one minimum.
class Conclusion {
 public:
  Conclusion(Problem& problem, const Minimum& best, const Problem::Residuals& at_best, Fit& result)
      : problem_(problem), best_(best), at_best_(at_best), result_(result) {
    find_combinations();
  }

  /// Tells misfit of each series from noise.
  void tell() {
    const auto parts = leftovers(problem_, best_.q);
    for (std::size_t d = 0; d < parts.size(); ++d) {
      const auto& m = (*problem_.data)[d];
      Told told{{}, parts[d].noise};
      if (m.kind == Measurement::Kind::motion) {
        const auto rates = problem_.predicted(problem_.at(best_.q), d, best_.q, {}).slip_rate;
        if (!rates.empty()) told = tell_misfit(m, rates, parts[d]);
      } else if (parts[d].series) {
        told = tell_misfit(m, imposed_slip_rate(m), parts[d]);
      }
      // What errors of the motion leave is no noise either, and counts in the errors already.
      if (told.misfit &&
          told.misfit->size * (parts[d].unknown ? 1 : m.error.front()) <= left_open_by_motion(problem_, best_.q, d))
        told = {{}, parts[d].noise};
      told_.push_back(std::move(told));
    }
  }

  bool misfits() const {
    return std::ranges::any_of(told_, [](const Told& told) { return told.misfit.has_value(); });
  }
  /// False where given errors are less than half of what residuals show: no interval is right then, by covariance or
  /// profile.
  bool described() const {
    constexpr double far_off = 4;  // times what errors allow
    return !problem_.errors_given() || best_.chi_square < far_off * (result_.points - double(problem_.free.size()));
  }
  /// The noise of each measurement, without misfit.
  const std::vector<Told>& told() const { return told_; }
  /// Standard error of q.
  double spread(std::size_t i) const { return std::sqrt(best_.covariance[i * problem_.free.size() + i]); }
  bool at_end_of_range(std::size_t i) const {
    const auto& v = problem_.variables[i];
    return best_.q[i] <= v.low + 1e-6 * v.scale || best_.q[i] >= v.high - 1e-6 * v.scale;
  }
  /// Where the law allows no more or no less of a number beside its others, as μ_d no more than μ_s.
  bool at_end_of_law(std::size_t i) const {
    if (at_end_of_range(i)) return false;
    const auto& v = problem_.variables[i];
    return std::ranges::any_of(std::array{-1, 1}, [&](int side) {
      auto beside = best_.q;
      beside[i] = std::clamp(beside[i] + side * 1e-3 * v.scale, v.low, v.high);
      return !problem_.residuals(beside);
    });
  }
  bool at_bound(std::size_t i) const { return at_end_of_range(i) || at_end_of_law(i); }
  /// Standard errors of the data per change of q by its scale.
  double influence(std::size_t i) const {
    double sum = 0;
    for (std::size_t k = 0; k < problem_.numbers(); ++k)
      sum = std::hypot(sum, at_best_.slopes[k * problem_.free.size() + i] * problem_.variables[i].scale);
    return sum;
  }
  /// Finds numbers that the predictions know only in combination: those of directions in which no residual changes.
  void find_combinations() {
    const auto p = Eigen::Index(problem_.free.size());
    Eigen::MatrixXd J = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        at_best_.slopes.data(), Eigen::Index(at_best_.values.size()), p);
    Eigen::VectorXd sizes = Eigen::VectorXd::Ones(p);
    for (Eigen::Index j = 0; j < p; ++j)
      if (const double size = J.col(j).norm(); size > 0) J.col(j) /= sizes[j] = size;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinV);
    constexpr double none = 1e-7, part = 0.05;
    combined_.assign(std::size_t(p), {});
    known_ = Eigen::MatrixXd::Zero(p, p);
    for (Eigen::Index k = 0; k < p; ++k) {
      const Eigen::VectorXd direction = svd.matrixV().col(k).cwiseQuotient(sizes);
      if (svd.singularValues()[k] > none * svd.singularValues()[0]) {
        known_.col(k) = direction / svd.singularValues()[k];
        continue;
      }
      unknown_.push_back(direction / direction.norm());
      std::vector<std::size_t> of;
      for (Eigen::Index j = 0; j < p; ++j)
        if (std::abs(svd.matrixV()(j, k)) > part) of.push_back(std::size_t(j));
      if (of.size() < 2) continue;  // a number that nothing depends on
      for (const auto i : of)
        for (const auto j : of)
          if (i != j) combined_[i] += (combined_[i].empty() ? "" : ", ") + problem_.variables[j].quantity.name;
    }
  }
  /// Why the data do not give this number an interval by its covariance; empty if they do.
  std::string lost(std::size_t i, double z) const {
    constexpr double none = 1e-6;
    const auto& v = problem_.variables[i];
    const auto& name = v.quantity.name;
    const double value = v.value(best_.q[i]);
    if (at_end_of_range(i))
      return fmt::format("{} = {:.6g} lies at an end of its range, {}: the fit ran away with it", name, value,
                         text(v.quantity.range));
    if (at_end_of_law(i))
      return fmt::format(
          "{} = {:.6g} lies at an end of what the law allows beside its other numbers: the data want it "
          "beyond",
          name, value);
    if (!combined_[i].empty())
      return fmt::format("the data do not determine {}: they tell of a combination of it with {} only", name,
                         combined_[i]);
    if (influence(i) < none)
      return fmt::format("the data do not depend on {}: {:.6g} is where the fit left it, without an interval", name,
                         value);
    if (!(z * spread(i) < v.high - v.low))
      return fmt::format("the data do not determine {}: its interval would be wider than its range, {}", name,
                         text(v.quantity.range));
    return {};
  }
  /// True where a normal law of q is a poor guide to the interval.
  bool in_doubt(std::size_t i, double z) const {
    constexpr double curved = 0.3;
    if (!combined_[i].empty() || misfits() || !described()) return false;
    return !lost(i, z).empty() || (problem_.variables[i].logarithmic && spread(i) > curved);
  }

  void parameter(std::size_t i, double z, bool profile, const std::function<void()>& report);
  void derive(const DerivedNumber& number, double z);
  void clock(std::size_t i);
  void measurements();

 private:
  /// Covariance of the variables, where the data know some in combination only that of what they know.
  Eigen::MatrixXd covariance() const {
    const auto p = Eigen::Index(problem_.free.size());
    if (unknown_.empty())
      return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          best_.covariance.data(), p, p);
    return known_ * known_.transpose();
  }
  /// What an offset of the clock would find in a record without one.
  Found clock_of(const Subject& model, Measurement m, std::size_t measurement, std::size_t row,
                 const std::vector<char>& apart) const {
    if (m.kind != Measurement::Kind::record || m.terms.clock_offset) return {};
    m.terms.clock_offset = true;
    return another_term(problem_, at_best_, measurement, row, predict(model, m).by_clock, apart);
  }
  Problem& problem_;
  const Minimum& best_;
  const Problem::Residuals& at_best_;
  Fit& result_;
  std::vector<std::string> combined_;     ///< for each variable: those that it cannot be told from
  std::vector<Eigen::VectorXd> unknown_;  ///< directions of variables in which no residual changes, of unit length
  Eigen::MatrixXd known_;                 ///< the others, each as far as its standard error
  std::vector<Told> told_;                ///< of each measurement
};

void Conclusion::parameter(std::size_t i, double z, bool profile, const std::function<void()>& report) {
  const auto& v = problem_.variables[i];
  const double error = spread(i);
  FittedParameter parameter{v.quantity.name, v.quantity.unit, v.value(best_.q[i])};
  parameter.standard_error = error * (v.logarithmic ? parameter.value : 1);
  parameter.low = v.value(best_.q[i] - z * error), parameter.high = v.value(best_.q[i] + z * error);
  parameter.at_bound = at_bound(i);
  parameter.profile_low = parameter.profile_high = std::nan("");
  double profile_low = v.low, profile_high = v.high;  // q
  if (profile && combined_[i].empty()) {
    const bool known = error > 0 && std::isfinite(error);
    const double first = known ? std::min(z * error, 3 * v.scale) : 3 * v.scale;
    profile_low = profile_end(problem_, best_, i, -first, z);
    report();
    profile_high = profile_end(problem_, best_, i, first, z);
    report();
    parameter.profile_low = v.value(profile_low), parameter.profile_high = v.value(profile_high);
  }
  // A number that no prediction hangs on, and one whose interval is wider than all that it may be, is not found; its
  // profile may still bound it on one side, as that of a spring too stiff to show.
  if (misfits()) {
    parameter.withheld = true;
    parameter.standard_error = parameter.low = parameter.high = std::nan("");
  } else if (const auto why = lost(i, z); !why.empty()) {
    const bool bounded = profile_low > v.low || profile_high < v.high;
    parameter.standard_error = parameter.low = parameter.high = std::nan("");
    result_.warnings.push_back(bounded
                                   ? fmt::format("the data bound {} on one side only: {:.3g} … {:.3g} by its profile",
                                                 parameter.path, parameter.profile_low, parameter.profile_high)
                                   : why);
    if (!bounded) {
      parameter.profile_low = parameter.profile_high = std::nan("");
      if (result_.outcome.complete() && described()) result_.outcome = {Ending::none_exists, why};
    }
  } else if (v.logarithmic && error > 1) {
    result_.warnings.push_back(fmt::format("{} is hardly determined: a factor of {:.2g} is within one standard error",
                                           parameter.path, std::exp(error)));
  }
  result_.parameters.push_back(parameter);
}

void Conclusion::derive(const DerivedNumber& number, double z) {
  const auto p = problem_.variables.size();
  const auto& paths = number.paths();
  const auto subject = problem_.at(best_.q);
  std::vector<double> numbers;
  std::vector<std::size_t> variable(paths.size(), p);  // at each path; p: a number of the scene that is not fitted
  for (std::size_t k = 0; k < paths.size(); ++k) {
    numbers.push_back(subject.get(paths[k]));
    for (std::size_t i = 0; i < p; ++i)
      if (problem_.variables[i].quantity.name == paths[k]) variable[k] = i;
  }
  struct At {
    double value;
    Eigen::VectorXd slopes;  // by the variables
  };
  const auto at = [&](const Eigen::VectorXd& q) {
    for (std::size_t k = 0; k < paths.size(); ++k)
      if (const auto i = variable[k]; i < p) numbers[k] = problem_.variables[i].value(q[Eigen::Index(i)]);
    const auto there = number.at(numbers);
    At result{there.value, Eigen::VectorXd::Zero(Eigen::Index(p))};
    for (std::size_t k = 0; k < paths.size(); ++k)
      if (const auto i = Eigen::Index(variable[k]); variable[k] < p)
        result.slopes[i] += there.slopes[k] * problem_.variables[variable[k]].slope(q[i]);
    return result;
  };
  const Eigen::VectorXd best = Eigen::Map<const Eigen::VectorXd>(best_.q.data(), Eigen::Index(p));
  const auto here = at(best);
  FittedParameter derived{number.name(), number.unit(), here.value};
  derived.profile_low = derived.profile_high = std::nan("");
  const auto unknown = [&](const std::string& why) {
    derived.standard_error = derived.low = derived.high = std::nan("");
    if (!why.empty()) result_.warnings.push_back(fmt::format("{} = {}: {}", number.name(), number.text(), why));
    result_.derived.push_back(derived);
  };
  if (misfits()) {
    derived.withheld = true;
    return unknown({});
  }
  if (!std::isfinite(here.value) || !here.slopes.allFinite()) return unknown("it is not finite at the fitted numbers");
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (variable[k] < p && here.slopes[Eigen::Index(variable[k])] != 0 && at_bound(variable[k]))
      return unknown(fmt::format("{} lies at an end of its range", paths[k]));
  constexpr double no_part = 1e-6;
  if (std::ranges::any_of(unknown_, [&](const auto& direction) {
        return std::abs(direction.dot(here.slopes)) > no_part * here.slopes.norm();
      }))
    return unknown("the data do not determine this combination");
  if (!unknown_.empty() && std::ranges::any_of(*problem_.data, moves))
    return unknown("the data know its numbers in combination only, and its error by that of the motion is not known");
  const Eigen::MatrixXd C = covariance();
  derived.standard_error = std::sqrt(std::max(0.0, here.slopes.dot(C * here.slopes)));
  // The point of the ellipsoid on which the formula is largest has its slopes for a normal: they are followed there.
  const auto extreme = [&](double side) {
    constexpr int most_rounds = 100;
    At there = here;
    double most = side * here.value;
    for (int round = 0; round < most_rounds; ++round) {
      const Eigen::VectorXd normal = C * there.slopes;
      const double spread = std::sqrt(std::max(0.0, there.slopes.dot(normal)));
      if (!(spread > 0)) break;
      const double before = there.value;
      there = at(best + side * z / spread * normal);
      if (!std::isfinite(there.value) || !there.slopes.allFinite()) return std::nan("");
      most = std::max(most, side * there.value);
      if (std::abs(there.value - before) <= 1e-12 * std::abs(there.value)) break;
    }
    return side * most;
  };
  derived.low = extreme(-1), derived.high = extreme(1);
  if (!std::isfinite(derived.low) || !std::isfinite(derived.high))
    return unknown("it is not finite throughout the intervals of its numbers");
  result_.derived.push_back(derived);
}

/// An offset that hangs on one or two points jumps between them rather than err as its covariance says.
void Conclusion::clock(std::size_t i) {
  double second = 0, fourth = 0;
  for (std::size_t k = 0; k < problem_.numbers(); ++k) {
    const double square = std::pow(at_best_.slopes[k * problem_.free.size() + i], 2);
    second += square, fourth += square * square;
  }
  const double points = second * second / fourth;
  constexpr double enough = 3;
  if (points < enough)
    result_.warnings.push_back(fmt::format(
        "{} hangs on {:.1f} points, those in the rise of friction after a step: its interval, and that of a "
        "stiffness fitted with it, are too narrow; sample the rise more densely",
        problem_.variables[i].quantity.name, points));
}

/// A step at whose own instant a sample reads friction from before it. Friction of a contact without a spring answers a
/// step at once, along its direction, and then goes on slowly: after such a sample it jumps.
std::optional<double> step_read_from_before(const Measurement& m) {
  constexpr double same_instant = 1e-9, beyond_noise = 6, slowly = 1.0 / 3;
  const double noise = roughness(m.y), span = m.x.back() - m.x.front();
  auto steps = m.later;
  steps.insert(steps.begin(), {m.step_at, m.next_slip_rate});
  double before = m.slip_rate;
  for (const auto& step : steps) {
    const double direction = std::abs(step.slip_rate) > std::abs(before) ? 1 : -1;
    for (std::size_t k = 0; k + 2 < m.y.size(); ++k) {
      const double jump = direction * (m.y[k + 1] - m.y[k]);
      if (std::abs(m.x[k] - step.at) <= same_instant * span && jump > beyond_noise * noise &&
          std::abs(m.y[k + 2] - m.y[k + 1]) < slowly * jump)
        return step.at;
    }
    before = step.slip_rate;
  }
  return std::nullopt;
}

void Conclusion::measurements() {
  using Trend = Measurement::Terms::Trend;
  const auto model = problem_.at(best_.q);
  std::size_t row = 0;
  for (std::size_t d = 0; d < problem_.data->size(); ++d) {
    const auto& m = (*problem_.data)[d];
    FittedMeasurement fitted;
    auto said = problem_.predicted(model, d, best_.q, {});
    fitted.fitted = std::move(said.y), fitted.bounded = std::move(said.bounded);
    fitted.error_found = m.error.empty();
    fitted.noise = problem_.noise[d];
    for (std::size_t k = 0; k < m.y.size(); ++k) {
      fitted.error.push_back(problem_.error(d, k));
      const double residual = (m.y[k] - fitted.fitted[k]) / fitted.error.back();
      fitted.residuals.push_back(fitted.bounded[k] ? beyond_noise(residual) : residual);
    }
    auto apart = fitted.bounded;
    for (std::size_t k = 0; k < m.y.size(); ++k) apart[k] = apart[k] || problem_.in_shadow(d, k);
    std::vector<double> independent;
    for (std::size_t k = 0; k < m.y.size(); ++k)
      if (!apart[k]) independent.push_back(at_best_.values[row + k]);
    fitted.neighbours = neighbours(independent);
    fitted.misfit = told_[d].misfit;
    constexpr std::size_t least = 20;      // points, of which a correlation tells something
    constexpr double by_chance = 3;        // standard deviations
    constexpr double fall_by_chance = 12;  // of χ²: 3.5 standard deviations
    if (m.series() && independent.size() >= least) {
      const bool has_trend = m.terms.trend != Trend::none;
      const double fall = has_trend ? 0 : another_term(problem_, at_best_, d, row, trend_over_time(m), apart).fall;
      const auto clock = clock_of(model, m, d, row, apart);
      const auto& n = fitted.neighbours;
      const auto neighbours =
          fmt::format("correlation of neighbours {:.2f}, Durbin-Watson {:.2f}", n.correlation, n.durbin_watson);
      // Against what is left, if that is more than noise: of residuals that a wrong law leaves any line takes some
      // away.
      double left = 0;
      for (const double r : independent) left += r * r / double(independent.size());
      const double by_chance_fall = fall_by_chance * std::max(1.0, left);
      if (clock.fall > std::max(by_chance_fall, fall))
        result_.warnings.push_back(fmt::format(
            "{}: a motion later by {:.2g} s would lower chi square by {:.4g}: differences over one side and filters "
            "delay a slip rate; set clock_offset = true in its data, or parameters with a time take it up, such as "
            "dampers",
            m.name, clock.value, clock.fall));
      else if (fall > by_chance_fall)
        result_.warnings.push_back(
            fmt::format("{}: a straight trend would lower chi square by {:.4g}; set trend = true in its data, or the "
                        "parameters take it up (residuals: {})",
                        m.name, fall, neighbours));
      else if (const auto& misfit = fitted.misfit)
        result_.warnings.push_back(fmt::format(
            "{}: residuals are no noise: {} they hang on the motion, by {:.2g} root mean square where the error is "
            "{:.2g} (by chance with a probability of {:.1g}; neighbours are correlated by {:.2f}, without that by "
            "{:.2f}): the law, or what the data say of the motion, does not describe these data, and no interval is "
            "given",
            m.name, misfit->where, misfit->size * (fitted.error_found ? 1 : fitted.error.front()), fitted.error.front(),
            misfit->probability, fitted.noise.correlation, told_[d].noise.correlation));
      else if (n.sigmas > by_chance)
        result_.warnings.push_back(fmt::format(
            "{}: residuals are correlated ({}): {}; intervals are too narrow", m.name, neighbours,
            fitted.error_found ? "the law or the terms of the laboratory do not describe these data"
            : has_trend ? "the law does not describe these data, or their noise is correlated, which is measured "
                          "where standard_error is left out"
                        : "the law does not describe these data, or they have a trend (trend = true), or correlated "
                          "noise, which is measured where standard_error is left out"));
    }
    if (m.kind == Measurement::Kind::velocity_step && !m.terms.clock_offset && !model.model.contact_stiffness.present())
      if (const auto step = step_read_from_before(m))
        result_.warnings.push_back(fmt::format(
            "{}: the sample at {:.6g} {}, the instant of a step, reads friction from before it, and friction "
            "jumps behind it: leave it out (low, high), or set clock_offset = true in its data",
            m.name, *step, m.over == Measurement::Over::time ? "s" : "m"));
    // What is flat within the noise after a step says nothing of how it went there.
    const auto unknown = [](const FittedParameter& parameter) { return std::isnan(parameter.low); };
    if (m.kind == Measurement::Kind::velocity_step && std::ranges::any_of(result_.parameters, unknown)) {
      double low = infinity, high = -infinity;
      const auto bare = predict(model, m).y;
      for (std::size_t k = 0; k < m.y.size(); ++k)
        if (m.x[k] >= m.step_at) low = std::min(low, bare[k]), high = std::max(high, bare[k]);
      if (high - low < fitted.error.front()) {
        const auto why = fmt::format(
            "{}: friction after the step at {:.4g} changes by {:.2g}, less than the standard error {:.2g}: "
            "the points lie outside the transient",
            m.name, m.step_at, high - low, fitted.error.front());
        const auto before = result_.outcome.complete() ? std::string() : result_.outcome.detail + "; ";
        result_.outcome = {Ending::none_exists, before + why};
      }
    }
    row += m.y.size();
    result_.measurements.push_back(std::move(fitted));
  }
}

/// The mean square of standardised residuals that were left out, in turn, of fits to the others. Left out together are
/// both parts of a response, and of a series stretches beyond which noise has forgotten itself.
/// \param told the noise of series that they are measured by, which knows no misfit
double cross_validation(Problem& problem, const Minimum& best, int folds, const std::vector<char>& apart,
                        const std::vector<Told>& told, const std::function<void()>& report) {
  const auto& data = *problem.data;
  std::vector<int> fold_of;  // each number
  for (std::size_t d = 0; d < data.size(); ++d) {
    const auto& m = data[d];
    constexpr double forgotten = 0.05;  // of the correlation
    const double rho = std::abs(problem.noise[d].correlation);
    const double memory = rho > forgotten ? std::log(forgotten) / std::log(rho) : 0;
    const double most = double(m.y.size()) / (2 * folds);
    const auto together = std::size_t(std::max(m.pairs() ? 2.0 : 1.0, std::min(std::ceil(memory), most)));
    for (std::size_t k = 0; k < m.y.size(); ++k) fold_of.push_back(int(k / together) % folds);
  }
  double sum = 0;
  for (int fold = 0; fold < folds; ++fold) {
    const auto use = [&](bool left_out) {
      problem.used.clear();
      for (const int own : fold_of) problem.used.push_back((own == fold) == left_out);
    };
    use(false);
    problem.q = best.q;
    const auto trained = minimise(problem);
    report();
    use(true);
    const auto own = problem.noise;
    for (std::size_t d = 0; d < data.size(); ++d)
      if (data[d].error.empty())
        problem.noise[d] = data[d].series() ? told[d].noise : SeriesNoise{roughness(data[d].y), 0};
    const auto left_out = problem.residuals(trained.q);
    problem.noise = own;
    for (std::size_t row = 0; row < fold_of.size(); ++row)
      if (fold_of[row] == fold) sum += left_out ? std::pow(left_out->values[row], 2) : infinity;
  }
  problem.used.clear();
  return sum / double(std::ranges::count(apart, 0));
}

}  // namespace

Fit fit(const Subject& model, const std::vector<Measurement>& data, const FitOptions& options) {
  gsl_set_error_handler_off();
  Problem problem{&model, &data, {}, {}, {}, {}, {}, {}, std::vector<std::vector<char>>(data.size()), 0};
  Fit result;
  if (options.parameters.empty()) throw InputError("a fit needs parameters");
  for (const auto& path : options.parameters) {
    problem.variables.push_back(make_variable(model, path));
    problem.q.push_back(problem.variables.back().of(model.get(path)));
  }
  const std::size_t of_model = problem.variables.size();
  const bool errors_given = problem.errors_given();
  for (std::size_t d = 0; d < data.size(); ++d) {
    const auto& m = data[d];
    check(m);
    if (m.kind == Measurement::Kind::motion) predict(model, m);  // a motion that ends early says why
    add_terms(problem.variables, m, d,
              std::ranges::any_of(data.begin(), data.begin() + std::ptrdiff_t(d), [&](const auto& other) {
                return m.kind == Measurement::Kind::motion && other.kind == m.kind && other.machine == m.machine;
              }));
    problem.trends.push_back(m.terms.trend == Measurement::Terms::Trend::none ? std::vector<double>{}
                                                                              : trend_abscissa(m));
    problem.noise.push_back({m.error.empty() ? roughness(m.y) : 1, 0});
    result.points += int(m.y.size());
    const bool repeats = m.kind == Measurement::Kind::stick_slip || m.kind == Measurement::Kind::motion;
    if (!m.pairs() && !repeats) {  // events repeat themselves, and what sticks stays where it is
      response::ClippingWatch watch;
      for (const double y : m.y) watch.add(y);
      if (auto clipped = response::clipping_warning(watch, m.name + ": friction", "1", long(m.y.size()));
          !clipped.empty())
        result.warnings.push_back(std::move(clipped));
    }
  }
  const std::size_t p = problem.variables.size();
  problem.q.resize(p, 0.0);
  for (std::size_t i = 0; i < p; ++i) problem.free.push_back(i);
  if (std::size_t(result.points) <= p)
    throw InputError(fmt::format("{} numbers do not determine {} parameters", result.points, p));

  constexpr int several = 4;
  const int asked = std::max(1, options.starts.value_or(1)), folds = options.folds > 1 ? options.folds : 0;
  int total = asked + (options.profiles.value_or(false) ? 2 * int(p) : 0) + folds, done = 0;
  const std::function<void()> report = [&] {
    if (options.progress) options.progress(++done, total);
  };
  const auto own = problem.q;
  const auto random = white_noise(of_model * std::size_t(std::max(asked, several)), options.seed);
  Minimum best;
  std::vector<char> apart;
  double expected = 0, most_expected = 0;  // of χ²
  const auto count_points = [&] {
    if (!std::isfinite(best.chi_square)) return;
    apart = problem.apart(best.q);
    const auto lost = std::ranges::count(apart, 1);
    result.points = int(problem.numbers()) - int(lost);
    if (std::size_t(result.points) <= p)
      throw InputError(
          fmt::format("{} numbers do not determine {} parameters: {} more are at rest, where friction is "
                      "bounded and not predicted, or behind missing rows",
                      result.points, p, lost));
    expected = double(result.points) - double(p);
    most_expected = expected + 4 * std::sqrt(2 * expected);
  };
  const auto search = [&](int from, int to) {
    const double offset = to - from > 1 ? near_enough : near;
    bool better = false;
    for (int s = from; s < to; ++s) {
      problem.q = own;
      const double spread = std::log(30.0) / 2;
      for (std::size_t i = 0; s > 0 && i < of_model; ++i) {
        const auto& v = problem.variables[i];
        problem.q[i] = std::clamp(own[i] + spread * v.scale * random[std::size_t(s) * of_model + i], v.low, v.high);
      }
      auto found = minimise(problem, offset);
      report();
      if (!std::isfinite(found.chi_square)) continue;
      result.converged_starts += found.converged;
      if (found.chi_square < best.chi_square) best = std::move(found), better = true;
    }
    if (better && offset > near) {
      problem.q = best.q;
      if (auto nearer = minimise(problem); nearer.chi_square < best.chi_square) best = std::move(nearer);
    }
  };
  const auto first_noise = problem.noise;
  // Noise and the numbers of the model in turn, until neither moves.
  const auto settle_noise = [&] {
    problem.q = best.q;
    constexpr int most_rounds = 10;
    for (int round = 0; !errors_given && best.converged && round < most_rounds; ++round) {
      const double changed = find_noise_at(problem, best);
      const auto before = problem.residuals(best.q);
      if (!before) break;
      double square = 0;
      for (const double r : before->values) square += r * r;
      auto again = minimise(problem);
      // Other weights of the same residuals may leave the minimum where it is, from which no step leads down.
      again.converged = again.converged || square - again.chi_square < 1e-6 * square;
      if (!again.converged) break;
      best = std::move(again);
      problem.q = best.q;
      if (changed < 1e-3) break;
    }
  };
  find_shadows(problem, problem.q);
  search(0, asked);
  count_points();
  const auto first = best;
  settle_noise();
  constexpr int most_shadows = 5;
  for (int round = 0; best.converged && round < most_shadows && find_shadows(problem, best.q); ++round) {
    problem.q = best.q;
    best = minimise(problem);
    count_points();
    settle_noise();
  }
  int starts = asked;
  if (!options.starts) {
    std::string doubt;
    if (!std::isfinite(best.chi_square))
      doubt = "the model does not answer to the first";
    else if (!best.converged)
      doubt = "the first did not converge";
    else if (best.chi_square > most_expected)
      doubt = fmt::format("the first left chi square at {:.4g} where {:.4g} is expected", best.chi_square, expected);
    else if (const auto r = problem.residuals(best.q, problem.free)) {
      const Conclusion at_first(problem, best, *r, result);
      for (std::size_t i = 0; i < p && doubt.empty(); ++i) doubt = at_first.lost(i, 2);
    }
    constexpr double rough = 3, close = 0.9;
    for (std::size_t d = 0; d < data.size() && doubt.empty(); ++d)
      if (data[d].error.empty() &&
          (problem.noise[d].size > rough * first_noise[d].size || problem.noise[d].correlation > close))
        doubt = fmt::format(
            "the first left {:.2g}, correlated by {:.2f}, in {}, whose neighbours differ as by noise of {:.2g}",
            problem.noise[d].size, problem.noise[d].correlation, data[d].name, first_noise[d].size);
    if (doubt.empty()) {
      result.decisions.push_back("no further starts: the first converged, its misfit is that of noise");
    } else {
      result.decisions.push_back(fmt::format("{} starts, because {}", several, doubt));
      total += several - asked, starts = several;
      problem.noise = first_noise, best = first;
      search(asked, several);
      count_points();
      settle_noise();
    }
  }
  if (!std::isfinite(best.chi_square))
    throw InputError("the model answers to none of the starts: its parameters do not allow this prediction");
  if (!best.converged)
    result.outcome = {
        Ending::budget_spent,
        fmt::format("the least squares did not converge from any of {} starts, within {} evaluations each", starts,
                    most_evaluations)};

  result.model = problem.at(best.q).model;
  result.chi_square = best.chi_square;
  for (std::size_t d = 0; d < data.size(); ++d)
    if (const auto lost = std::ranges::count(problem.shadows[d], 1); lost > 0)
      result.decisions.push_back(
          fmt::format("{}: {} of {} points are left out, whose friction hangs on the motion while rows were missing",
                      data[d].name, lost, data[d].y.size()));
  auto at_best = problem.residuals(best.q, problem.free);
  if (!at_best) {
    result.outcome = {Ending::not_finite, "predictions at the least squares, or their slopes, are not finite"};
    return result;
  }
  take_secants(problem, best, *at_best);
  const auto of_motions = count_motions(problem, best, *at_best);
  // Where the size of noise is found as well, few points have the wider intervals of Student's distribution.
  const double below = 0.5 + options.confidence / 2;
  const double z = errors_given ? gsl_cdf_ugaussian_Pinv(below) : gsl_cdf_tdist_Pinv(below, expected);
  Conclusion conclusion(problem, best, *at_best, result);
  conclusion.tell();
  std::vector<char> profiled(p, options.profiles.value_or(false));
  for (std::size_t i = 0; !options.profiles && i < p; ++i) profiled[i] = conclusion.in_doubt(i, z);
  const auto profiles = std::ranges::count(profiled, 1);
  if (!options.profiles) {
    total += 2 * int(profiles);
    result.decisions.push_back(
        !conclusion.described() ? "no profiles of the likelihood: the law does not describe the data"
        : profiles == 0         ? "no profiles of the likelihood: every covariance is narrow"
                                : fmt::format("profiles of the likelihood for {} of {} numbers, whose covariance is "
                                                      "wide",
                                              profiles, p));
  }
  for (std::size_t i = 0; i < p; ++i) {
    conclusion.parameter(i, z, profiled[i], report);
    constexpr double most_of_it = 0.5;
    if (of_motions[i] > most_of_it * best.covariance[i * p + i])
      result.warnings.push_back(fmt::format(
          "the error of {} comes from that of the recorded motion: {:.0f} % of its square, the bias by it included",
          problem.variables[i].quantity.name, 100 * of_motions[i] / best.covariance[i * p + i]));
    if (problem.variables[i].term == Variable::Term::clock_offset) conclusion.clock(i);
    for (std::size_t j = 0; j < p; ++j) {
      const double product = best.covariance[i * p + i] * best.covariance[j * p + j];
      result.correlation.push_back(product > 0 ? best.covariance[i * p + j] / std::sqrt(product) : std::nan(""));
      if (j < i && std::abs(result.correlation.back()) > 0.99)
        result.warnings.push_back(fmt::format("{} and {} are told apart poorly: correlation {:.4f}",
                                              problem.variables[j].quantity.name, problem.variables[i].quantity.name,
                                              result.correlation.back()));
    }
  }
  for (const auto& number : options.derived) conclusion.derive(number, z);
  if (errors_given && best.chi_square > most_expected)
    result.warnings.push_back(fmt::format(
        "chi square is {:.4g} where {:.4g} is expected: the law does not describe these data, or their errors are "
        "larger than stated; intervals are too narrow",
        best.chi_square, expected));
  conclusion.measurements();

  double deviance = 0, count = double(p);
  std::size_t row = 0;
  for (std::size_t d = 0; d < data.size(); ++d) {
    // A law that bounds a point and one that predicts it are to be compared: it counts as noise alone would leave it.
    const double n = double(data[d].y.size());
    double square = 0, predicted = 0;
    for (std::size_t k = 0; k < data[d].y.size(); ++k, ++row)
      square += at_best->values[row] * at_best->values[row], predicted += !apart[row];
    if (!data[d].error.empty()) {
      deviance += square + n - predicted;
      continue;
    }
    const auto& noise = problem.noise[d];
    if (predicted > 0) deviance += n * std::log(noise.size * noise.size * square / predicted);
    deviance += (n - 1) * std::log(1 - std::pow(noise.correlation, 2));
    count += noise.correlation != 0 ? 2 : 1;
  }
  result.aic = deviance + 2 * count;
  result.bic = deviance + count * std::log(double(problem.numbers()));

  result.cross_validation =
      folds > 0 ? cross_validation(problem, best, folds, apart, conclusion.told(), report) : std::nan("");
  result.predictions = problem.predictions, result.steps = problem.steps;
  return result;
}

}  // namespace rosin::analysis::inference
