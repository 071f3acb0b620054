/// Responses and curves from the contact's derivatives; steps, holds and records as motion of the contact under an
/// imposed slip rate.
#include "analysis/inference/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/inference/machine_motion.hpp"
#include "analysis/inference/stick_slip.hpp"
#include "analysis/response/contact_slopes.hpp"
#include "analysis/response/frf.hpp"
#include "core/error.hpp"
#include "core/random.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::inference {

namespace {

constexpr int most = Slopes<double>::capacity;

/// What is imposed on a contact from `begin` on, until the next: a slip rate with an even jerk, and a load that changes
/// evenly.
struct Stretch {
  double begin, slip_rate, normal_load, acceleration = 0, load_rate = 0;
  double direction = double((slip_rate > 0) - (slip_rate < 0));
  double jerk = 0;
  bool rests = false;
  double slip_rate_at(double t) const { return slip_rate + (t - begin) * (acceleration + (t - begin) * jerk / 2); }
  double acceleration_at(double t) const { return acceleration + (t - begin) * jerk; }
  double normal_load_at(double t) const { return normal_load + (t - begin) * load_rate; }
  /// m, from its begin on.
  double way_to(double t) const {
    const double span = t - begin;
    return span * (slip_rate + span * (acceleration / 2 + span * jerk / 6));
  }
};

/// How the static limit of a law that sticks changes with a number of its model.
class LimitSlope {
 public:
  LimitSlope(const Model& model, const std::string& path) : law_(model.law), changed_(model.law) {
    if (!law_->set_valued()) return;
    constexpr double small = 1e-6;
    for (const double part : {small, -small}) try {
        step_ = part * model.get(path);
        changed_ = model.with(path, model.get(path) + step_).law;
        return;
      } catch (const InputError&) {  // the law's end of that number
      }
  }
  double at(double normal_load) const {
    if (law_ == changed_ || step_ == 0) return 0;
    return (changed_->static_limit(normal_load) - law_->static_limit(normal_load)) / step_;
  }

 private:
  std::shared_ptr<const FrictionLaw> law_, changed_;
  double step_ = 0;
};

/// A contact under an imposed motion and load as a system, and what numbers of the model do to it. Lists of slopes S
/// are unknowns × numbers, row-major.
class ImposedContact final : public System {
 public:
  /// \param model,contact,slopes,limit_slopes kept by reference.
  /// \param motion in the order of time; the first lasts from ever.
  /// \param typical the slip rate in whose steady sliding errors are measured.
  ImposedContact(const Model& model, const Contact<double>& contact, const std::vector<response::ContactSlopes>& slopes,
                 const std::vector<LimitSlope>& limit_slopes, std::vector<Stretch> motion, double typical)
      : motion_(std::move(motion)),
        typical_(typical),
        model_(model),
        contact_(&contact),
        slopes_(slopes),
        limit_slopes_(limit_slopes) {
    contact_->mass(motion_.front().normal_load, mass_);
    double z[most];
    contact_->steady(0, along(typical), motion_.front().normal_load, z, scale_);
    for (int i = 0; i < size(); ++i) scale_[i] = std::max(scale_[i], 1e-30);
  }

  int size() const override { return contact_->unknowns(); }
  bool autonomous() const override {
    const auto& only = motion_.front();
    return motion_.size() == 1 && only.acceleration == 0 && only.jerk == 0 && only.load_rate == 0;
  }
  void mass(double, double* m) const override {
    for (int i = 0; i < size(); ++i) m[i] = algebraic(i) ? 0 : 1;
  }
  void evaluate(double t, const double* z, double* f) const override {
    const auto in = input(t);
    double F, M[most];
    contact_->evaluate(in, z, f, F);
    contact_->mass(in.normal_load, M);
    for (int i = 0; i < size(); ++i) f[i] /= divisor(i, M);
  }
  void linearise(double t, const double* z, double* f, double* jacobian) const override {
    const int n = size();
    const auto in = input(t);
    Slopes<double> slopes;
    double F, M[most];
    contact_->linearise(in, z, f, F, slopes);
    contact_->mass(in.normal_load, M);
    for (int i = 0; i < n; ++i) {
      f[i] /= divisor(i, M);
      for (int j = 0; j < n; ++j) jacobian[i * n + j] = slopes.g_z[i * n + j] / divisor(i, M);
    }
  }
  void scale(const double*, double* s) const override { std::copy_n(scale_, size(), s); }
  std::string unknown(int i) const override { return fmt::format("unknown {} of the contact", i); }
  double next_break(double t) const override {
    const auto next = following(t);
    return next == motion_.end() ? infinity : next->begin;
  }

  /// True where slip rate or load jump at this break: algebraic unknowns then do.
  bool jumps(double t) const {
    const auto next = following(t);
    const auto& after = *(next - 1);
    if (next - 1 == motion_.begin()) return false;
    const auto& before = *(next - 2);
    constexpr double rounding = 1e-12;
    return std::abs(before.slip_rate_at(t) - after.slip_rate) > rounding * std::abs(typical_) ||
           std::abs(before.normal_load_at(t) - after.normal_load) > rounding * after.normal_load;
  }
  Stretch at(double t) const {
    const auto next = following(t);
    if (next != motion_.begin()) return *(next - 1);
    auto first = motion_.front();  // as it begins, so it was
    first.acceleration = first.jerk = first.load_rate = 0;
    return first;
  }
  std::size_t stretches() const { return motion_.size(); }
  int numbers() const { return int(slopes_.size()); }
  /// Slopes of f by the numbers.
  void force(double t, const double* z, double* f_p) const {
    const auto in = input(t);
    double f[most], M[most];
    evaluate(t, z, f);
    contact_->mass(in.normal_load, M);
    for (int p = 0; p < numbers(); ++p) {
      const auto change = slopes_[std::size_t(p)].values(in, z);
      for (int i = 0; i < size(); ++i)
        f_p[i * numbers() + p] = (change.g[std::size_t(i)] - f[i] * change.mass[std::size_t(i)]) / divisor(i, M);
    }
  }
  /// Unknowns before the motion, and their slopes: of steady sliding as it begins, or, from rest, midway between those
  /// of slowest creep either way, which leaves deflections and the force of a machine at 0.
  std::vector<double> before(std::vector<double>& S) const {
    const auto& first = motion_.front();
    if (first.slip_rate != 0) return steady(first.slip_rate, S);
    std::vector<double> back;
    auto z = steady(FrictionLaw::slowest_creep, S);
    const auto mirrored = steady(-FrictionLaw::slowest_creep, back);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] = (z[i] + mirrored[i]) / 2;
    for (std::size_t i = 0; i < S.size(); ++i) S[i] = (S[i] + back[i]) / 2;
    return z;
  }
  /// Makes S consistent with an algebraic row at z, as a jump of the slip rate has left it.
  void settle(double t, const double* z, std::vector<double>& S) const {
    const int n = size();
    double f[most], J[most * most];
    std::vector<double> f_p(std::size_t(n * numbers()));
    linearise(t, z, f, J);
    force(t, z, f_p.data());
    for (int i = 0; i < n; ++i) {
      if (!algebraic(i)) continue;
      for (int p = 0; p < numbers(); ++p) {
        double sum = f_p[std::size_t(i * numbers() + p)];
        for (int j = 0; j < n; ++j)
          if (j != i) sum += J[i * n + j] * S[std::size_t(j * numbers() + p)];
        S[std::size_t(i * numbers() + p)] = -sum / J[i * n + i];
      }
    }
  }
  /// dF/dt at z, on its way.
  double friction_rate(double t, const double* z) const {
    const int n = size();
    const auto in = input(t);
    const auto stretch = at(t);
    const double acceleration = stretch.acceleration_at(t);
    Slopes<double> slopes;
    double f[most], M[most], rate[most] = {}, F;
    contact_->linearise(in, z, f, F, slopes);
    contact_->mass(in.normal_load, M);
    for (int i = 0; i < n; ++i)
      if (!algebraic(i)) rate[i] = f[i] / M[i];
    for (int i = 0; i < n; ++i) {
      if (!algebraic(i)) continue;
      rate[i] = -(slopes.g_u[i] * acceleration + slopes.g_N[i] * stretch.load_rate) / slopes.g_z[i * n + i];
      for (int j = 0; j < n; ++j)
        if (j != i) rate[i] -= slopes.g_z[i * n + j] * rate[j] / slopes.g_z[i * n + i];
    }
    double sum = slopes.F_u * acceleration + slopes.F_N * stretch.load_rate;
    for (int i = 0; i < n; ++i) sum += slopes.F_z[i] * rate[i];
    return sum;
  }
  double friction(double t, const double* z) const {
    double g[most], F;
    contact_->evaluate(input(t), z, g, F);
    return F;
  }
  /// Adds friction at these unknowns and its slopes to the prediction, as the measurement's y.
  void read(const Measurement& m, double t, const double* z, const std::vector<double>& S,
            Prediction& prediction) const {
    const auto in = input(t);
    const double unit = m.in_force ? 1 : in.normal_load;
    const bool bounded = model_.law->set_valued() && (in.slip_rate == 0 || at(t).rests);
    prediction.bounded.push_back(bounded);
    if (bounded) {
      prediction.y.push_back(model_.law->static_limit(in.normal_load) * in.normal_load / unit);
      for (int p = 0; p < numbers(); ++p)
        prediction.slopes[std::size_t(p)].push_back(limit_slopes_[std::size_t(p)].at(in.normal_load) * in.normal_load /
                                                    unit);
      if (m.terms.clock_offset) prediction.by_clock.push_back(0);
      return;
    }
    Slopes<double> slopes;
    double g[most], F;
    contact_->linearise(in, z, g, F, slopes);
    prediction.y.push_back(F / unit);
    for (int p = 0; p < numbers(); ++p) {
      double change = slopes_[std::size_t(p)].values(in, z).F;
      for (int i = 0; i < size(); ++i) change += slopes.F_z[i] * S[std::size_t(i * numbers() + p)];
      prediction.slopes[std::size_t(p)].push_back(change / unit);
    }
    if (!m.terms.clock_offset) return;
    const double pace = m.over == Measurement::Over::displacement ? std::abs(in.slip_rate) : 1;
    const double scaling = m.in_force ? 0 : F * in.load_rate / in.normal_load;
    prediction.by_clock.push_back(-(friction_rate(t, z) - scaling) / unit / pace);
  }

 private:
  std::vector<Stretch>::const_iterator following(double t) const {
    return std::ranges::upper_bound(motion_, t, {}, &Stretch::begin);
  }
  ContactInput<double> input(double t) const {
    const auto stretch = at(t);
    return {stretch.slip_rate_at(t), stretch.normal_load_at(t), stretch.load_rate, stretch.direction};
  }
  std::vector<double> steady(double slip_rate, std::vector<double>& S) const {
    const double N = motion_.front().normal_load;
    double z[most], weight[most], g[most], F;
    contact_->steady(0, along(slip_rate), N, z, weight);
    const int n = size();
    const ContactInput<double> in{slip_rate, N, 0, double((slip_rate > 0) - (slip_rate < 0))};
    Slopes<double> slopes;
    contact_->linearise(in, z, g, F, slopes);
    const std::vector<double> A(slopes.g_z, slopes.g_z + n * n);
    S.assign(std::size_t(n * numbers()), 0.0);
    for (int p = 0; p < numbers(); ++p) {
      const auto shift = slopes_[std::size_t(p)].steady(in, z, A);
      for (int i = 0; i < n; ++i) S[std::size_t(i * numbers() + p)] = shift[std::size_t(i)];
    }
    return {z, z + n};
  }
  bool algebraic(int i) const { return mass_[i] == 0; }
  double divisor(int i, const double* M) const { return algebraic(i) ? 1 : M[i]; }
  /// The slip rate that a law is asked at for its steady sliding.
  double along(double slip_rate) const { return model_.law->set_valued() ? std::abs(slip_rate) : slip_rate; }

  std::vector<Stretch> motion_;
  double typical_;  ///< slip rate, m/s
  const Model& model_;
  const Contact<double>* contact_;
  const std::vector<response::ContactSlopes>& slopes_;
  const std::vector<LimitSlope>& limit_slopes_;
  double mass_[most] = {}, scale_[most] = {};
};

void respond(const Model& model, const std::vector<std::string>& paths, const Measurement& m, Prediction& prediction) {
  const response::FrictionResponse response(model);
  std::vector<response::ResponseSlope> slopes;
  for (const auto& path : paths) slopes.emplace_back(response, model, path);
  const auto add = [](std::vector<double>& list, std::complex<double> Z) {
    list.push_back(Z.real()), list.push_back(Z.imag());
  };
  for (const double f : m.x) {
    const auto passage = response.passage({0, 2 * std::numbers::pi * f});
    add(prediction.y, passage.force);
    for (std::size_t p = 0; p < paths.size(); ++p) add(prediction.slopes[p], slopes[p](passage).slope);
  }
}

/// Motion of a contact under what is imposed on it, and its slopes by the numbers of the model.
class ImposedMotion {
 public:
  ImposedMotion(const ImposedContact& contact, const std::string& name, double time, const std::vector<double>& start,
                std::vector<double> S)
      : contact_(contact), name_(name), solver_(contact, 1e-10), S_(std::move(S)) {
    begin(time, start);
  }
  const std::vector<double>& state() const { return solver_.state(); }
  const std::vector<double>& slopes() const { return S_; }
  double time() const { return solver_.time(); }
  long steps() const { return solver_.count().steps; }

  void to(double time) {
    while (solver_.time() < time) {
      const double end = std::min(time, contact_.next_break(solver_.time()));
      step(end);
      propagate();
      if (solver_.time() >= end && contact_.at(end).begin == end && contact_.jumps(end))
        begin(end, std::vector<double>(state()));
    }
  }
  /// To the first maximum of friction, or to where it does not rise any more.
  void to_peak() {
    double before = contact_.friction_rate(time(), state().data());
    std::vector<double> z(state().size());
    const auto rate_at = [&](double t, const double* at) { return contact_.friction_rate(t, at); };
    for (bool found = !(before > 0); !found; propagate()) {
      step(infinity);
      double low = 0;
      for (int i = 0; i < solvers::steps::Collocation::stages && !found; ++i) {
        solver_.stage(i, z.data());
        const double here = contact_.friction_rate(solver_.stage_time(i), z.data());
        if (here < 0) {
          const auto at = solver_.locate(rate_at, low, solver_.node(i), before, here);
          if (!at || !solver_.shorten(*at)) throw InputError(name_ + ": the peak could not be located");
          found = true;
        }
        low = solver_.node(i), before = here;
      }
      constexpr double settled = 1e-13;  // of friction, that it still rises by in as much time as has passed
      found = found || before * solver_.time() <= settled * std::abs(contact_.friction(time(), state().data()));
    }
  }

 private:
  void begin(double time, const std::vector<double>& start) {
    if (!solver_.start(time, start)) throw InputError(name_ + ": the motion cannot begin");
    contact_.settle(time, solver_.state().data(), S_);
  }
  void step(double limit) {
    // Motion that parameters far off have made stiff or fast must not take for ever.
    const long most_steps = 20'000 + 10 * long(contact_.stretches());
    if (solver_.count().steps >= most_steps)
      throw InputError(
          fmt::format("{}: the motion takes more than {} steps to t = {:.3g} s", name_, most_steps, solver_.time()));
    if (const auto outcome = solver_.step(limit); !outcome.complete())
      throw InputError(fmt::format("{}: the motion could not be followed: {}", name_, outcome.detail));
  }
  void propagate() {
    if (contact_.numbers() > 0)
      solver_.propagate(S_, contact_.numbers(),
                        [&](double t, const double* z, double* f_p) { contact_.force(t, z, f_p); });
  }

  const ImposedContact& contact_;
  const std::string& name_;
  solvers::steps::Collocation solver_;
  std::vector<double> S_;
};

/// The motion that is imposed in a step or a record, and the times of x in it.
struct Imposed {
  std::vector<Stretch> motion;
  std::vector<double> times;
};

Imposed steps_of(const Measurement& m, double clock_offset) {
  const double N = m.normal_load;
  // Each stretch begins at an x, and x goes on by `pace` for each second of it.
  const auto pace = [&](double slip_rate) {
    return m.over == Measurement::Over::displacement ? std::abs(slip_rate) : 1;
  };
  std::vector<double> begins = {m.step_at};
  Imposed imposed{{{0, m.slip_rate, N}, {0, m.next_slip_rate, N}}, {}};
  for (const auto& step : m.later) {
    const auto& last = imposed.motion.back();
    imposed.motion.push_back({last.begin + (step.at - begins.back()) / pace(last.slip_rate), step.slip_rate, N});
    begins.push_back(step.at);
  }
  for (const double x : m.x) {
    const double at = x - clock_offset;
    std::size_t i = 0;  // of the stretch that it lies in
    while (i < begins.size() && begins[i] <= at) ++i;
    const double from = begins[i == 0 ? 0 : i - 1], begin = imposed.motion[i].begin;
    imposed.times.push_back(begin + (at - from) / pace(imposed.motion[i].slip_rate));
  }
  return imposed;
}

/// The times within a stretch of length `span`, counted from its begin, at which its slip rate passes through 0.
std::vector<double> reversals(const Stretch& stretch, double span) {
  std::vector<double> found;
  const double u = stretch.slip_rate, a = stretch.acceleration, half_jerk = stretch.jerk / 2;
  if (half_jerk == 0) {
    if (a != 0) found = {-u / a};
  } else if (const double square = a * a - 4 * half_jerk * u; square > 0) {
    const double q = -(a + std::copysign(std::sqrt(square), a)) / 2;
    found = {q / half_jerk, q == 0 ? 0 : u / q};
    std::ranges::sort(found);
  }
  // One that a step cannot resolve from the ends, or two from each other, is none.
  const double ulps = 64 * std::numeric_limits<double>::epsilon() * std::abs(stretch.begin + span);
  const double least = std::max(1e-9 * span, ulps);
  std::erase_if(found, [&](double wait) { return !(wait > least && span - wait > least); });
  if (found.size() == 2 && found[1] - found[0] < least) found.clear();
  return found;
}

Imposed record_of(const Measurement& m, double clock_offset) {
  const auto& history = m.history;
  const auto &time = history.time, &load = history.normal_load;
  Imposed imposed;
  for (std::size_t i = 0; i + 1 < time.size(); ++i) {
    const double span = time[i + 1] - time[i], u = history.slip_rate[i], next = history.before(i + 1);
    const auto& way = history.recorded.displacement;
    const double mean = way.empty() ? (u + next) / 2 : (way[i + 1] - way[i]) / span;
    Stretch stretch{time[i], u, load[i], 0, (load[i + 1] - load[i]) / span};
    stretch.rests = history.rests(i);
    stretch.jerk = 6 * (u + next - 2 * mean) / (span * span);
    stretch.acceleration = (next - u) / span - stretch.jerk * span / 2;
    // Laws have a corner where slip reverses: a stretch ends there.
    auto ends = reversals(stretch, span);
    ends.push_back(span);
    const auto whole = stretch;
    double from = 0;
    for (const double to : ends) {
      const double middle = whole.slip_rate_at(time[i] + (from + to) / 2);
      stretch.direction = double((middle > 0) - (middle < 0));
      imposed.motion.push_back(stretch);
      const double at = time[i] + to;
      stretch = {at,         0,          whole.normal_load_at(at), whole.acceleration_at(at), whole.load_rate, 0,
                 whole.jerk, whole.rests};
      from = to;
    }
  }
  imposed.motion.push_back({time.back(), history.slip_rate.back(), load.back()});
  imposed.motion.back().rests = history.rests(time.size() - 1);
  for (const double x : m.x) imposed.times.push_back(x - clock_offset);
  return imposed;
}

/// Friction at each time of an imposed motion, from steady sliding, or rest, as it begins.
void follow(const ImposedContact& contact, const std::vector<double>& times, const Measurement& m,
            Prediction& prediction) {
  std::vector<double> S;
  const auto start = contact.before(S);
  const double begin = contact.next_break(-infinity);
  std::optional<ImposedMotion> motion;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double time = times[k];
    if (time < begin || contact.size() == 0) {
      contact.read(m, time, start.data(), S, prediction);
      continue;
    }
    if (!motion) motion.emplace(contact, m.name, begin, start, S);
    motion->to(time);
    contact.read(m, motion->time(), motion->state().data(), motion->slopes(), prediction);
  }
  if (motion) prediction.steps += motion->steps();
}

/// Peaks as the drive resumes from each hold: where a spring yields, those of a motion of their own.
void follow_holds(const ImposedContact& resting, const ImposedContact& sliding, const Measurement& m, bool reload,
                  Prediction& prediction) {
  std::vector<double> S;
  const auto start = sliding.before(S);
  if (resting.size() == 0) {
    for (std::size_t k = 0; k < m.x.size(); ++k) sliding.read(m, 0, start.data(), S, prediction);
    return;
  }
  ImposedMotion motion(resting, m.name, 0, start, S);
  for (std::size_t k = 0; k < m.x.size(); ++k) {
    motion.to(m.x[k]);
    if (!reload) {
      sliding.read(m, 0, motion.state().data(), motion.slopes(), prediction);
      continue;
    }
    ImposedMotion again(sliding, m.name, 0, motion.state(), motion.slopes());
    again.to_peak();
    sliding.read(m, again.time(), again.state().data(), again.slopes(), prediction);
    prediction.steps += again.steps();
  }
  prediction.steps += motion.steps();
}

void refuse_remembered_rest(const Model& model, const Measurement& m, const std::vector<Stretch>& motion) {
  if (!model.law->set_valued() || !model.law->has_states()) return;
  const auto rests = [](const Stretch& s) { return s.slip_rate == 0 || s.rests; };
  if (std::ranges::any_of(motion, rests))
    throw InputError(
        fmt::format("{}: law '{}' sticks and remembers; its friction is followed under a recorded slip rate as long as "
                    "that does not come to 0 or reverse",
                    m.name, model.law->card().name));
}

}  // namespace

Measurement::History Measurement::History::again(std::uint64_t seed) const {
  auto history = *this;
  if (slip_rate_noise == 0) {
    history.recorded = recorded_again(time, recorded, seed);
    history.slip_rate = history.recorded.after;
    return history;
  }
  auto normal = white_noise(time.size(), seed);
  // At rest a sensor reads nothing but its noise, and how its neighbours are correlated.
  const double noise = rest.found ? rest.noise : slip_rate_noise;
  double square = 0, product = 0;
  for (std::size_t i = 0; rest.found && i + 1 < time.size(); ++i)
    if (rests(i) && rests(i + 1) && std::abs(slip_rate[i]) <= rest.below && std::abs(slip_rate[i + 1]) <= rest.below)
      square += slip_rate[i] * slip_rate[i], product += slip_rate[i] * slip_rate[i + 1];
  const double correlation = square > 0 ? std::clamp(product / square, -0.95, 0.95) : 0;
  for (std::size_t i = 1; i < normal.size(); ++i)
    normal[i] = correlation * normal[i - 1] + std::sqrt(1 - correlation * correlation) * normal[i];
  double moved = 0;
  const auto off = [&](std::size_t i) { return slip_rate[i] != 0 ? noise * normal[i] : 0; };
  for (std::size_t i = 0; i < time.size(); ++i) {
    history.slip_rate[i] += off(i);
    history.recorded.before[i] += off(i);
    if (i > 0) moved += (off(i - 1) + off(i)) / 2 * (time[i] - time[i - 1]);
    history.recorded.displacement[i] += moved;
  }
  return history;
}

Measurement::History Measurement::History::across(bool as_behind) const {
  auto history = *this;
  auto& way = history.recorded.displacement;
  for (const auto i : gaps) {
    const double span = time[i + 1] - time[i], mean = (recorded.displacement[i + 1] - recorded.displacement[i]) / span;
    const double rate = slip_rate_noise == 0 ? mean : as_behind ? before(i + 1) : slip_rate[i];
    history.slip_rate[i] = history.recorded.before[i + 1] = rate;
    for (std::size_t k = i + 1; k < way.size(); ++k) way[k] += (rate - mean) * span;
  }
  return history;
}

namespace {

/// As `predict`, of a contact and by numbers of the law alone.
Prediction predict_contact(Model model, const Measurement& m, std::vector<std::string> own, double clock_offset) {
  using Kind = Measurement::Kind;
  double fastest = m.slip_rate;
  if (m.kind == Kind::record) {
    fastest = 0;
    for (const double u : m.history.slip_rate) fastest = std::max(fastest, std::abs(u));
    if (fastest == 0) throw InputError(fmt::format("{}: nothing moves in this record", m.name));
  }
  model.drive = {fastest, m.normal_load, 0.0};
  if (m.kind == Kind::hold && (!model.law->has_states() || model.lambda == 0))
    throw InputError(fmt::format("law '{}' without states does not remember a hold", model.law->card().name));
  const bool reload = m.kind == Kind::hold && model.contact_stiffness.present();
  if (reload && model.law->set_valued())
    throw InputError(
        fmt::format("{}: law '{}' sticks to its spring when sliding resumes, which a hold does not follow; leave "
                    "law.contact_stiffness out, or use 'rosin lab slide-hold-slide'",
                    m.name, model.law->card().name));
  if (m.kind == Kind::steady_curve) {
    model.contact_stiffness = {};
    model.lambda = 0;
  }

  Prediction found{{}, std::vector<std::vector<double>>(own.size())};
  if (m.kind == Kind::frequency_response) {
    respond(model, own, m, found);
  } else {
    const auto setup = response::imposed_contact_setup(model);
    const auto contact = model.law->contact(setup);
    std::vector<response::ContactSlopes> slopes;
    std::vector<LimitSlope> limit_slopes;
    for (const auto& path : own) slopes.emplace_back(model, setup, path), limit_slopes.emplace_back(model, path);
    const auto under = [&](std::vector<Stretch> motion, double typical) {
      return ImposedContact(model, *contact, slopes, limit_slopes, std::move(motion), typical);
    };
    const auto held = [&](double slip_rate, double typical) { return under({{0, slip_rate, m.normal_load}}, typical); };
    if (m.kind == Kind::steady_curve) {
      for (std::size_t k = 0; k < m.x.size(); ++k) {
        const auto sliding = held(m.x[k], m.x[k]);
        std::vector<double> S;
        const auto z = sliding.before(S);
        sliding.read(m, 0, z.data(), S, found);
      }
    } else if (m.kind == Kind::velocity_step) {
      auto imposed = steps_of(m, clock_offset);
      follow(under(std::move(imposed.motion), m.next_slip_rate), imposed.times, m, found);
    } else if (m.kind == Kind::record) {
      auto imposed = record_of(m, clock_offset);
      refuse_remembered_rest(model, m, imposed.motion);
      follow(under(std::move(imposed.motion), fastest), imposed.times, m, found);
    } else {
      const auto sliding = held(m.slip_rate, m.slip_rate);
      follow_holds(held(0, m.slip_rate), sliding, m, reload, found);
    }
  }
  return found;
}

}  // namespace

Prediction predict(const Subject& subject, const Measurement& m, const std::vector<std::string>& paths,
                   double clock_offset) {
  using Kind = Measurement::Kind;
  if (m.kind == Kind::motion) return predict_motion(subject, m, paths, clock_offset);
  const bool knows_slider = m.kind == Kind::stick_slip;
  std::vector<std::string> own = paths;
  std::erase_if(own, [&](const std::string& path) {
    if (m.machine) return !subject.machines.at(*m.machine)->depends_on(path);
    return !path.starts_with("law.") && !(knows_slider && path.starts_with("oscillator."));
  });
  if (m.kind == Kind::steady_curve)  // which knows neither the clock of the states, nor a spring
    std::erase_if(own,
                  [](const auto& path) { return path.starts_with("law.contact_stiffness.") || path == "law.lambda"; });
  auto prediction =
      knows_slider ? predict_stick_slip(subject, m, own) : predict_contact(subject.model, m, own, clock_offset);
  std::vector<std::vector<double>> slopes;
  for (const auto& path : paths) {
    const auto at = std::ranges::find(own, path);
    slopes.push_back(at == own.end() ? std::vector<double>(prediction.y.size(), 0.0)
                                     : prediction.slopes[std::size_t(at - own.begin())]);
  }
  prediction.slopes = std::move(slopes);
  return prediction;
}

namespace {
Imposed imposed_by(const Measurement& m) {
  return m.kind == Measurement::Kind::record ? record_of(m, 0) : steps_of(m, 0);
}
/// What an imposed motion has at each time, of the stretch that it lies in.
template <class Ask>
std::vector<double> at_each(const Imposed& imposed, Ask ask) {
  const auto& motion = imposed.motion;
  std::vector<double> values;
  for (const double t : imposed.times) {
    const auto next = std::upper_bound(motion.begin() + 1, motion.end(), t,
                                       [](double time, const Stretch& stretch) { return time < stretch.begin; });
    values.push_back(ask(std::size_t(next - motion.begin()) - 1, t));
  }
  return values;
}
/// m that were imposed up to each time, from the begin of the second stretch of a step, or of a record.
std::vector<double> way_of(const Imposed& imposed) {
  const auto& motion = imposed.motion;
  std::vector<double> before = {0};  // each stretch
  for (std::size_t i = 0; i + 1 < motion.size(); ++i)
    before.push_back(before.back() + motion[i].way_to(motion[i + 1].begin));
  return at_each(imposed, [&](std::size_t i, double t) { return before[i] + motion[i].way_to(t); });
}
}  // namespace

std::vector<double> imposed_displacement(const Measurement& m) {
  if (!m.imposed()) return {};
  return way_of(imposed_by(m));
}

std::vector<double> imposed_slip_rate(const Measurement& m) {
  const auto imposed = imposed_by(m);
  return at_each(imposed, [&](std::size_t i, double t) { return imposed.motion[i].slip_rate_at(t); });
}

std::vector<double> imposed_normal_load(const Measurement& m) {
  const auto imposed = imposed_by(m);
  return at_each(imposed, [&](std::size_t i, double t) { return imposed.motion[i].normal_load_at(t); });
}

std::vector<double> trend_abscissa(const Measurement& m) {
  using Over = Measurement::Over;
  if (m.kind == Measurement::Kind::motion) {
    std::vector<double> s;
    for (const double x : m.x) s.push_back(x - m.x.front());
    return s;
  }
  const bool by_displacement = m.terms.trend == Measurement::Terms::Trend::displacement;
  const bool record = m.kind == Measurement::Kind::record;
  if (!record && by_displacement == (m.over == Over::displacement)) {
    std::vector<double> s;
    for (const double x : m.x) s.push_back(x - m.step_at);
    return s;
  }
  if (by_displacement) return imposed_displacement(m);
  if (!record) return steps_of(m, 0).times;
  const auto imposed = record_of(m, 0);
  auto s = imposed.times;
  for (double& t : s) t -= imposed.motion.front().begin;
  return s;
}

}  // namespace rosin::analysis::inference
