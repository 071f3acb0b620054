/// Disturbances carried along a motion and orthonormalised, and their mean growth with its error.
#include "analysis/cycles/lyapunov.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "analysis/cycles/motion_range.hpp"
#include "analysis/cycles/section_map.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "core/eigenpairs.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;
using oscillators::StructureSystem;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

namespace {

enum class Directions { all, one };

/// Orthonormal disturbances of the unknowns that move, each in its scale: as many as there are unknowns, or one of all.
class Frame {
 public:
  Frame(StructureSystem& system, Directions directions) : system_(system), n_(system.size()) {
    std::vector<double> rest(n_);
    scale_.resize(n_);
    system.scale(rest.data(), scale_.data());
    moving_ = moving_unknowns(system);
    columns_ = directions == Directions::all ? int(moving_.size()) : 1;
    restart();
  }
  void restart() {
    lost.assign(columns_, false);
    tangent.assign(std::size_t(n_) * columns_, 0.0);
    for (int k = 0; k < int(moving_.size()); ++k) at(moving_[k], std::min(k, columns_ - 1)) = scale_[moving_[k]];
    begin();
  }
  /// Growth is counted from here.
  void begin() {
    growth.assign(columns_, 0.0), stuck.assign(system_.contacts(), 0.0);
    divergence = duration = 0, switches = 0;
  }
  int columns() const { return columns_; }
  /// Unknown by unknown, so that volumes tell of all of them.
  bool is_whole() const { return columns_ == int(moving_.size()); }

  /// After a step: what it has added to the growth of each direction, in the order of Gram and Schmidt.
  void add(const Follower::Step& step, std::span<const Follower::Event> events) {
    std::vector<double> y(n_);
    double trace = 0;
    bool forgets = !events.empty();
    for (int c = 0; c < system_.contacts(); ++c) forgets = forgets || system_.mode(c) == ContactMode::stick;
    for (int i = 0; is_whole() && i < Follower::Step::stages; ++i) {
      step.stage(i, y.data());
      trace += solvers::steps::RadauTableau::get().b[i] * step.length() * trace_at(step.stage_time(i), y.data());
    }
    divergence += trace;
    const double grown = orthonormalise(forgets);
    // Volumes shrink by the divergence of the flow (Liouville), even where a step does not resolve how the direction
    // that shrinks most does it, since what it comes to is right.
    if (is_whole() && system_.contacts() == 0 && system_.stops() == 0) growth.back() += trace - grown;
    duration += step.length();
    switches += long(events.size());
    for (int c = 0; c < system_.contacts(); ++c)
      if (system_.mode(c) == ContactMode::stick) stuck[c] += step.length();
  }

  std::vector<double> tangent;  ///< size × columns, row-major
  std::vector<double> growth;   ///< ln, of each direction
  std::vector<bool> lost;       ///< directions that were forgotten
  double divergence = 0, duration = 0;
  long switches = 0;
  std::vector<double> stuck;  ///< s, of each contact

 private:
  double& at(int row, int column) { return tangent[std::size_t(row) * columns() + column]; }
  double product(int a, int b) {
    double sum = 0;
    for (const int i : moving_) sum += at(i, a) * at(i, b) / (scale_[i] * scale_[i]);
    return sum;
  }
  void add_column(int to, int from, double factor) {
    for (int i = 0; i < n_; ++i) at(i, to) += factor * at(i, from);
  }
  /// Takes away from a column what it has of those before it. \returns its length, and that from before
  std::pair<double, double> set_upright(int c) {
    const double before = std::sqrt(product(c, c));
    for (int pass = 0; pass < 2; ++pass)  // the second takes away what rounding left of the first
      for (int b = 0; b < c; ++b)
        if (!lost[b]) add_column(c, b, -product(b, c));
    return {std::sqrt(product(c, c)), before};
  }
  /// \param forgets  stick or a switch may have taken a direction; else one is only too short to be seen, and drawn
  /// anew \returns what all have grown by
  double orthonormalise(bool forgets) {
    constexpr double rounding = 1e-13;
    double grown = 0;
    for (int c = 0; c < columns(); ++c) {
      if (lost[c]) continue;
      auto [length, before] = set_upright(c);
      const bool is_gone = !(length > rounding * before);
      lost[c] = is_gone && forgets;
      if (!lost[c]) {
        const double factor = std::max(length, rounding * before);
        growth[c] += std::log(factor), grown += std::log(factor);
      }
      for (std::size_t k = 0; is_gone && !forgets && k < moving_.size(); ++k) {
        for (int i = 0; i < n_; ++i) at(i, c) = i == moving_[k] ? scale_[i] : 0;
        length = set_upright(c).first;
        if (length > 0.5 / std::sqrt(double(columns()))) break;
      }
      for (int i = 0; i < n_; ++i) at(i, c) = lost[c] ? 0 : at(i, c) / length;
    }
    return grown;
  }
  double trace_at(double t, const double* y) const {
    RowMajor J(n_, n_);
    VectorXd mass(n_), scale(n_);
    std::vector<double> f(n_);
    system_.linearise(t, y, f.data(), J.data());
    system_.mass(t, mass.data());
    system_.scale(y, scale.data());
    return moving_part(J, mass, scale).A.trace();
  }

  StructureSystem& system_;
  int n_, columns_;
  std::vector<int> moving_;
  std::vector<double> scale_;
};

/// Piece after piece of a motion, with its frame if asked. A piece is a period of the drive; of a motion that is not
/// driven it is the longest natural period, from the same moment each: a long run would round its phase.
class Pieces {
 public:
  Pieces(SectionMap& map, std::vector<double> start, double tolerance, Directions directions = Directions::all)
      : frame(map.system(), directions), y(std::move(start)), accuracy(tolerance), system_(map.system()) {
    if (directions == Directions::one) range_.emplace(map.system());
  }
  /// s
  static double length(const SectionMap& map) {
    constexpr double of_patience = 1e-3;
    return map.driven() ? map.drive_period() : of_patience * map.patience();
  }
  Outcome follow(double duration, bool carried, const std::function<void()>& stepped = {}) {
    Follower follower(system_, accuracy);
    if (range_) range_->begin(y);
    if (carried) {
      follower.carry(&frame.tangent, frame.columns());
      follower.observe = [&](Follower::Step& step, std::span<const Follower::Event> events) {
        frame.add(step, events);
        if (range_) range_->add(step.state());
        if (stepped) stepped();
      };
    }
    const auto outcome = follower.follow(0, y, duration);
    cost.steps += follower.count().steps, cost.evaluations += follower.count().evaluations;
    return outcome;
  }

  /// Half range (m) of the coordinate that moved most in the last piece that carried its one disturbance.
  std::optional<double> size() const {
    return range_ ? std::optional(range_->size().head(system_.coordinates()).maxCoeff()) : std::nullopt;
  }

  Frame frame;
  std::vector<double> y;
  double accuracy;
  LyapunovSpectrum::Cost cost;

 private:
  StructureSystem& system_;
  std::optional<MotionRange> range_;
};

void take_over(LyapunovSpectrum& spectrum, const Frame& frame) {
  spectrum.duration = frame.duration;
  spectrum.switches = frame.switches;
  spectrum.divergence = frame.divergence / frame.duration;
  for (const double time : frame.stuck) spectrum.stick_fraction.push_back(time / frame.duration);
}

void sort_and_add(LyapunovSpectrum& spectrum) {
  std::ranges::stable_sort(spectrum.exponents, std::greater(), &Exponent::value);
  spectrum.sum = 0;
  for (const auto& exponent : spectrum.exponents)
    if (std::isfinite(exponent.value)) spectrum.sum += exponent.value;
}

/// The exponent nearest to 0 of a motion that is not driven and not at rest is that along its flow.
void mark_trivial(LyapunovSpectrum& spectrum) {
  if (spectrum.clocks > 0 || spectrum.exponents.empty()) return;
  std::ranges::min_element(spectrum.exponents, {}, [](const auto& e) { return std::abs(e.value); })->trivial = true;
}

/// ln|μ|/T of the multipliers that are known; of the others, too small for that, by the growth over a period.
void take_from_cycle(LyapunovSpectrum& spectrum, SectionMap& map, double accuracy) {
  const StructureCycle& cycle = spectrum.cycle;
  const double period = cycle.metrics.at("period").value;
  Pieces pieces(map, cycle.start, accuracy);
  Frame& frame = pieces.frame;
  // The last of some periods, in which directions have found their order, at a finer tolerance, which shows the error.
  constexpr int periods = 6;
  constexpr double finer = 1e-2;
  std::vector<double> before;
  for (int k = 0; k < periods; ++k) {
    before = frame.growth;
    frame.begin();
    pieces.y = cycle.start;
    const bool last = k + 1 == periods;
    if (last) pieces.accuracy = finer * accuracy;
    if (last) spectrum.time.assign(1, 0.0), spectrum.course.assign(frame.growth.size(), {0.0});
    const int parts = map.driven() ? cycle.returns : 1;
    for (int part = 0; part < parts; ++part) {
      const auto outcome = pieces.follow(period / parts, true, [&] {
        if (!last) return;
        spectrum.time.push_back(frame.duration);
        for (std::size_t c = 0; c < frame.growth.size(); ++c) spectrum.course[c].push_back(frame.growth[c]);
      });
      if (!outcome.complete()) {
        spectrum.outcome = outcome;
        return;
      }
    }
  }
  spectrum.cost.steps += pieces.cost.steps, spectrum.cost.evaluations += pieces.cost.evaluations;
  spectrum.from = "cycle";
  take_over(spectrum, frame);
  std::vector<std::vector<double>> course;
  for (std::size_t c = 0; c < frame.growth.size(); ++c) {
    if (frame.lost[c]) {
      spectrum.exponents.push_back({-infinity, 0});
      continue;
    }
    const double rounding = std::abs(spectrum.divergence) * accuracy;
    spectrum.exponents.push_back({frame.growth[c] / period, std::abs(frame.growth[c] - before[c]) / period + rounding});
    course.push_back(std::move(spectrum.course[c]));
  }
  spectrum.course = std::move(course);
  std::ranges::stable_sort(spectrum.exponents, std::greater(), &Exponent::value);
  std::vector<Exponent> known;
  if (!map.driven()) known.push_back({0, accuracy / period, true});
  for (std::size_t i = 0; i < cycle.multipliers.size(); ++i) {
    const double modulus = std::abs(cycle.multipliers[i]), error = cycle.multiplier_errors[i];
    constexpr double well = 1e-2;
    if (error < well * modulus) known.push_back({std::log(modulus) / period, error / modulus / period});
  }
  std::ranges::stable_sort(known, std::greater(), &Exponent::value);
  for (std::size_t i = 0; i < std::min(known.size(), spectrum.exponents.size()); ++i)
    if (std::isfinite(spectrum.exponents[i].value)) spectrum.exponents[i] = known[i];
  sort_and_add(spectrum);
}

void take_from_steady(LyapunovSpectrum& spectrum, const steady::StructureStability& sliding) {
  spectrum.from = "steady";
  spectrum.outcome = {};
  for (const auto& mode : sliding.modes)
    for (int k = 0; k < (mode.eigenvalue.imag() != 0 ? 2 : 1); ++k)
      spectrum.exponents.push_back({mode.growth_rate(), mode.error});
  sort_and_add(spectrum);
  spectrum.divergence = spectrum.sum;
}

/// Growth of each direction in each piece of the average, and its mean so far.
class Average {
 public:
  void add(const Pieces& pieces) {
    const Frame& frame = pieces.frame;
    if (series_.empty()) series_.resize(frame.growth.size()), before_.assign(frame.growth.size(), 0.0);
    for (std::size_t c = 0; c < series_.size(); ++c) {
      series_[c].push_back(frame.growth[c] - before_[c]);
      before_[c] = frame.growth[c];
    }
    time_.push_back(frame.duration);
    if (const auto size = pieces.size()) sizes_.push_back(std::log(*size));
  }
  long pieces() const { return long(time_.size()); }
  BlockedError error_of(std::size_t direction) const {
    auto error = blocked_error(series_[direction]);
    error.value *= double(pieces()) / time_.back();
    return error;
  }
  /// The motion is as large in the second half as in the first, by their errors.
  bool keeps_its_size() const {
    constexpr double agree = 4;
    const auto middle = sizes_.begin() + pieces() / 2;
    const std::vector<double> before(sizes_.begin(), middle), after(middle, sizes_.end());
    const auto mean = [](const auto& series) {
      return std::accumulate(series.begin(), series.end(), 0.0) / double(series.size());
    };
    return std::abs(mean(after) - mean(before)) <=
           agree * std::hypot(blocked_error(before).value, blocked_error(after).value);
  }
  void take(LyapunovSpectrum& spectrum, const Frame& frame) const {
    constexpr long most = 1000;  // moments of the course
    const long stride = std::max(1L, pieces() / most);
    for (long k = stride - 1; k < pieces(); k += stride) spectrum.time.push_back(time_[k]);
    std::vector<std::pair<double, std::vector<double>>> courses;
    for (std::size_t c = 0; c < series_.size(); ++c) {
      if (frame.lost[c]) {
        spectrum.exponents.push_back({-infinity, 0});
        continue;
      }
      const auto error = error_of(c);
      spectrum.levelled = spectrum.levelled && error.levelled;
      spectrum.exponents.push_back({frame.growth[c] / frame.duration, error.value});
      auto& [value, course] = courses.emplace_back(frame.growth[c] / frame.duration, std::vector<double>());
      double sum = 0;
      for (long k = 0; k < pieces(); ++k) {
        sum += series_[c][k];
        if (k % stride == stride - 1) course.push_back(sum / time_[k]);
      }
    }
    std::ranges::stable_sort(courses, std::greater(), [](const auto& c) { return c.first; });
    for (auto& [value, course] : courses) spectrum.course.push_back(std::move(course));
    sort_and_add(spectrum);
  }

 private:
  std::vector<std::vector<double>> series_;  ///< [direction][piece]
  std::vector<double> before_, time_;
  std::vector<double> sizes_;  ///< [piece], ln of Pieces::size
};

constexpr long first_look = 256;  ///< pieces before a tolerance is thought to be met
constexpr double further = 1.25;  ///< pieces at the next look, over those at the last

/// Follows `relaxing` pieces, in whose second half directions find their order, and then adds pieces to the average
/// until there are enough.
Outcome add_pieces(Pieces& pieces, double piece, long relaxing, Average& average, const std::function<bool()>& enough) {
  for (long k = 0; k < relaxing; ++k) {
    end_if_stopped();
    if (k == relaxing / 2) pieces.frame.restart();
    if (const auto outcome = pieces.follow(piece, k >= relaxing / 2); !outcome.complete()) return outcome;
  }
  pieces.frame.begin();
  do {
    end_if_stopped();
    if (const auto outcome = pieces.follow(piece, true); !outcome.complete()) return outcome;
    average.add(pieces);
  } while (!enough());
  return {};
}

void take_from_average(LyapunovSpectrum& spectrum, SectionMap& map, const motion::StructureModel& model,
                       const LyapunovOptions& options, long relaxing) {
  Pieces pieces(map, motion::starting_point(map.system(), model.start), options.accuracy);
  Frame& frame = pieces.frame;
  Average average;
  const double piece = Pieces::length(map);
  spectrum.from = "average";
  spectrum.transient = double(relaxing) * piece;
  const long wanted = options.duration > 0 ? std::max(1L, std::lround(options.duration / piece)) : 0;
  long next_look = first_look;
  bool spent = false;
  const auto enough = [&] {
    if (std::ranges::all_of(frame.lost, std::identity())) return true;
    if (options.progress && wanted > 0) options.progress(double(average.pieces()) / double(wanted));
    if (pieces.cost.steps > options.most_steps) return spent = true;
    if (wanted > 0 && average.pieces() >= wanted) return true;
    if (options.tolerance == 0 || average.pieces() < next_look) return false;
    const auto leading = std::size_t(std::ranges::find(frame.lost, false) - frame.lost.begin());
    const auto error = average.error_of(leading);
    if (error.levelled && error.value <= options.tolerance) return true;
    next_look = long(further * double(next_look));
    if (options.progress && wanted == 0)
      options.progress(std::min(1.0, options.tolerance * options.tolerance / (error.value * error.value)));
    return false;
  };
  try {
    spectrum.outcome = add_pieces(pieces, piece, relaxing, average, enough);
    if (spent)
      spectrum.outcome = {Ending::budget_spent,
                          fmt::format("{} steps, of {:.9g} s", options.most_steps, frame.duration)};
  } catch (const Stopped&) {
    spectrum.outcome = {Ending::interrupted, fmt::format("{:.9g} s of the average are kept", frame.duration)};
  }
  spectrum.cost.steps += pieces.cost.steps, spectrum.cost.evaluations += pieces.cost.evaluations;
  if (average.pieces() == 0) return;
  take_over(spectrum, frame);
  average.take(spectrum, frame);
  mark_trivial(spectrum);
  if (spectrum.outcome.complete() && options.tolerance > 0 && wanted > 0 && !spectrum.exponents.empty() &&
      spectrum.exponents.front().error > options.tolerance)
    spectrum.outcome = {Ending::tolerance_not_met, fmt::format("after {:.9g} s the largest exponent is known to {:.2g} "
                                                               "1/s; give lyapunov.duration more, or leave it out",
                                                               frame.duration, spectrum.exponents.front().error)};
}

}  // namespace

BlockedError blocked_error(std::vector<double> series) {
  constexpr std::size_t fewest = 16;
  BlockedError result{infinity, false};
  while (series.size() >= fewest) {
    const double count = double(series.size()), before = result.value;
    double mean = 0, squares = 0;
    for (const double x : series) mean += x / count;
    for (const double x : series) squares += (x - mean) * (x - mean);
    const double now = std::sqrt(squares / (count * (count - 1))), of_itself = now / std::sqrt(2 * (count - 1));
    if (std::abs(now - before) <= of_itself) return {std::max(before, now), true};
    result = {now, now < before && std::isfinite(before)};
    for (std::size_t i = 0; i + 1 < series.size(); i += 2) series[i / 2] = (series[i] + series[i + 1]) / 2;
    series.resize(series.size() / 2);
  }
  return result;
}

LyapunovSpectrum lyapunov_spectrum(const motion::StructureModel& model, const LyapunovOptions& options) {
  if (!(options.duration > 0) && !(options.tolerance > 0))
    throw InputError("lyapunov: give a duration (s), or a tolerance of the largest exponent (1/s)");
  SectionMap map(model.structure);
  constexpr int most_dense = 64;
  if (map.system().size() > most_dense)
    throw InputError(fmt::format("Lyapunov exponents are for up to {} unknowns; this structure has {}", most_dense,
                                 map.system().size()));
  LyapunovSpectrum spectrum;
  spectrum.clocks = map.driven() ? 1 : 0;
  const double piece = Pieces::length(map);
  constexpr long usual_transient = 100;
  constexpr double part = 0.1;
  const long relaxing = options.transient >= 0 ? std::lround(options.transient / piece)
                        : options.duration > 0 ? std::lround(part * options.duration / piece)
                                               : usual_transient;
  StructureCycleOptions how;
  how.tolerance = options.accuracy, how.stick_threshold = options.stick_threshold;
  constexpr long most_returns = 10'000, usual_returns = 1000;
  how.max_cycles = int(options.duration > 0 ? std::clamp(long(relaxing + options.duration / piece), 20L, most_returns)
                                            : usual_returns);
  spectrum.cycle = find_cycle(model, how);
  spectrum.cost = {spectrum.cycle.cost.steps, spectrum.cycle.cost.evaluations};
  if (!spectrum.cycle.multipliers.empty()) {
    take_from_cycle(spectrum, map, options.accuracy);
    return spectrum;
  }
  if (!map.driven() && spectrum.cycle.outcome.ending == Ending::none_exists) {
    if (const auto sliding = steady::stability(model.structure); sliding.stable) {
      take_from_steady(spectrum, sliding);
      return spectrum;
    }
  }
  take_from_average(spectrum, map, model, options, relaxing);
  return spectrum;
}

std::optional<Exponent> largest_exponent(const motion::StructureModel& model, double mean_return, long most_returns) {
  SectionMap map(model.structure);
  constexpr long relaxing = 30, most_steps = 1'000'000;
  std::vector<double> y = motion::starting_point(map.system(), model.start);
  std::optional<Exponent> before;
  // Two parts of the motion, the second by finer steps: an exponent that is one of the steps differs.
  for (const double accuracy : {1e-8, 1e-10}) {
    Pieces pieces(map, y, accuracy, Directions::one);
    Average average;
    long next_look = first_look;
    Exponent found{NAN, infinity};
    const auto enough = [&] {
      if (pieces.frame.lost[0]) return true;
      const bool spent = pieces.cost.steps > most_steps || average.pieces() >= most_returns;
      if (average.pieces() < next_look && !spent) return false;
      next_look = long(further * double(next_look));
      const auto error = average.error_of(0);
      const double of_steps = accuracy * double(pieces.cost.steps) / pieces.frame.duration;
      found = {pieces.frame.growth[0] / pieces.frame.duration, error.value + of_steps};
      return spent || (error.levelled && !found.is_zero());
    };
    const auto outcome = add_pieces(pieces, map.driven() ? map.drive_period() : mean_return, relaxing, average, enough);
    if (!outcome.complete() || !std::isfinite(found.error) || !average.keeps_its_size()) return std::nullopt;
    y = pieces.y;
    if (before)
      return Exponent{(before->value + found.value) / 2,
                      std::max({before->error, found.error, std::abs(before->value - found.value) / 2})};
    before = found;
  }
  return std::nullopt;
}

Outcome outcome_of(const std::optional<Exponent>& exponent, long returns, Outcome unknown) {
  if (!exponent) return unknown;
  const auto text = fmt::format("{:.3g} ± {:.1g} 1/s", exponent->value, exponent->error);
  if (exponent->value > 0 && !exponent->is_zero())
    return {Ending::none_exists,
            fmt::format("chaotic: neighbouring motions diverge at {}, the largest Lyapunov exponent", text)};
  return {Ending::budget_spent, fmt::format("no period within {} returns; exponent {}", returns, text)};
}

}  // namespace rosin::analysis::cycles
