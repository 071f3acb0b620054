/// The search for the fixed point of the map of onsets: plain periods, leaps along what they have in common, Newton's
/// method.
#include "analysis/cycles/onset_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "analysis/cycles/multipliers.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The way to the onset that repeats itself. Plain periods lead to what attracts; where they come in, what they have in
/// common leads there faster (a leap). Many slow states, such as the temperatures of deep layers, come in one after the
/// other; Newton's method turns them all at once, and the fast ones follow within a few periods. Where leaps lead
/// astray again and again it is not waited for so long.
class OnsetMap::Search {
 public:
  Search(OnsetMap& map, VectorXd onset) : map_(map), z_(std::move(onset)) {}

  /// Where the next period begins.
  const VectorXd& onset() const { return z_; }
  /// True if a leap or Newton's method led there, that have not been judged yet.
  bool led() const { return leapt_at_ >= 0 || k_ <= judged_at_; }
  /// True once Newton's method has had a part in where this is.
  bool turned() const { return judged_at_ >= 0; }

  /// Takes the onset that ends the period.
  void add(const VectorXd& image) {
    onsets_.push_back(z_), changes_.push_back(image - z_);
    now_ = map_.size_of_step(changes_.back(), z_);
    onward_ = accelerated();
    // Onsets before a leap say nothing of those after it.
    together_ = std::min<std::size_t>(onsets_.size(), k_ - last_leap_);
    scatters_ = scatter_in(std::span(changes_).last(together_));
    if (now_ < 0.5 * nearest_) nearest_ = now_, nearest_at_ = k_;
    comes_in_slowly_ = k_ > 3 && now_ < 1e3 * known() && !(now_ < 0.5 * change_);
    settled_ = now_ < 10 * known() || comes_in_slowly_;
    // What neither leads closer, and changes to and fro, is as close as rounding lets it come.
    no_nearer_ = k_ - nearest_at_ >= 2 * patience && now_ < 100 * nearest_ && !led() && scatters_;
  }
  /// True if `period`, the last one, is as close to what repeats itself as plain periods come.
  bool has_arrived(const StickSlipPeriod& period) const {
    // States that count the time at rest scatter as the times at which slip stops, and what has all but decayed as the
    // rounding of what it came from. Then the metrics of two periods that both do show what is left.
    const bool unshaken = now_ < 10 * closest_;  // by a leap
    return settled_ || std::max(now_, change_) < 3 * map_.scatter(period) || (unshaken && go_nowhere()) || no_nearer_;
  }
  /// What is left of the way, relative, where metrics `changed` by so much in the last period.
  double open(double changed) const {
    if (!settled_) return 10 * changed;
    // Metrics may change by more than states do, as stick does that ends the sooner the hotter the contact is.
    const double moved = onsets_.size() > 1 ? map_.size_of_step(z_ - onsets_.end()[-2], z_) : infinity;
    return (moved > 0 ? std::max(changed / moved, 1.0) : 1) * away();
  }
  /// True if plain periods may have stopped short of what repeats itself.
  bool may_be_short() const {
    constexpr double many = 1e3;  // periods from what repeats itself, or rounding says so
    return map_.kind_ == Onset::reversed || comes_in_slowly_ || no_nearer_ || (settled_ && away() > many * now_);
  }
  /// To which no state is known better.
  double known() const { return std::max(map_.tolerance_, 1e-14); }
  /// The number of kinds of slip, two or more, that follow each other by turns: a period then holds as many. Else 1.
  int alternating() const {
    constexpr std::size_t enough = 8, most = 8;
    constexpr double alike = 1e-3, apart = 1e-3;
    const auto last = std::span(onsets_).last(together_);
    const VectorXd image = z_ + changes_.back();
    for (std::size_t n = 2; n <= most && last.size() >= enough + n && now_ > apart; ++n)
      if (map_.size_of_step(image - last[last.size() - n], image) < alike * now_) return int(n);
    return 1;
  }
  bool asks_for_newton() const { return k_ >= turn_at_ && k_ > judged_at_ && !scatters_; }

  /// Takes Newton's way, or where there is none puts the next try off and goes on without.
  void turn(const std::optional<VectorXd>& way) {
    if (!way) {
      turn_at_ = k_ + patience;
      return go_on();
    }
    come_closer();
    onsets_.clear(), changes_.clear();
    z_ += *way;
    change_ = infinity;
    leapt_at_ = -1;
    judged_at_ = k_ + 1 + grace;
    turn_at_ = judged_at_ + plain;
    ++k_;
  }
  /// Goes on from where the last period ended, or leaps.
  void go_on() {
    // What a leap does to fast states is gone within a few periods.
    const bool farther = now_ > 2 * closest_, waits = leapt_at_ >= 0 && k_ <= leapt_at_ + grace;
    if (farther && !waits && (leapt_at_ >= 0 || k_ == judged_at_)) {
      go_back();
    } else {
      if (!farther) leapt_at_ = -1;
      come_closer();
      constexpr double comes_in = 1 - 1e-7;
      const bool leaps = leapt_at_ < 0 && k_ > plain_until_ && k_ > judged_at_ &&
                         std::max(now_ / change_, change_ / change_before_) < comes_in;
      if (leaps) leapt_at_ = last_leap_ = k_;
      z_ += leaps ? onward_ : changes_.back();
    }
    change_before_ = change_;
    change_ = now_;
    ++k_;
  }
  /// Where slip led to finds no end: beyond where it comes to rest, to which periods by themselves may never lead.
  void stray() {
    go_back();
    if (constexpr int most_strays = 5; strays_ > most_strays) plain_until_ = most_periods;
    ++k_;
  }
  /// Periods hold another number of slips from here on.
  void begin_anew(const VectorXd& onset) {
    z_ = onset;
    onsets_.clear(), changes_.clear();
    closest_ = change_ = infinity;
    ++k_;
  }
  const VectorXd& change() const { return changes_.back(); }
  bool goes_on() const { return k_ < most_periods; }

 private:
  static constexpr int most_periods = 400, plain = 6, patience = 24, grace = 4;

  double away() const { return std::max(now_, map_.size_of_step(onward_, z_)); }
  void come_closer() {
    if (now_ < closest_) closest_ = now_, closest_image_ = z_ + changes_.back();
  }
  void go_back() {
    constexpr int again = 2;
    onsets_.clear(), changes_.clear();
    z_ = closest_image_;
    const bool turned = k_ <= judged_at_;
    plain_until_ = k_ + ++strays_ * plain;
    if (turned || strays_ >= again) turn_at_ = k_ + (turned ? patience : plain);
    leapt_at_ = judged_at_ = -1;
  }
  /// The way from the last onset to the one that repeats itself: Anderson mixing of the last periods, and no farther
  /// than half of what each state is.
  VectorXd accelerated() const {
    constexpr std::size_t depth = 6;
    const VectorXd z = onsets_.back(), step = changes_.back(), sizes = map_.sizes_at(z);
    const std::size_t m = std::min({depth, onsets_.size() - 1, std::size_t(z.size())});
    if (m == 0) return step;
    MatrixXd moved(z.size(), m), differed(z.size(), m);
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t at = onsets_.size() - 1 - i;
      moved.col(i) = (onsets_[at] - onsets_[at - 1]).cwiseQuotient(sizes);
      differed.col(i) = (changes_[at] - changes_[at - 1]).cwiseQuotient(sizes);
    }
    const VectorXd share = least_squares(differed, step.cwiseQuotient(sizes));
    VectorXd onward = step - ((moved + differed) * share).cwiseProduct(sizes);
    if (!onward.allFinite()) return step;
    const auto farthest = [&](const VectorXd& way) { return way.cwiseQuotient(sizes).cwiseAbs().maxCoeff(); };
    constexpr double most = 0.5;
    // Changes that differ by rounding alone, as where heat only adds up, point anywhere.
    if (onward.cwiseQuotient(sizes).dot(step.cwiseQuotient(sizes)) < 0) onward = step * (most / farthest(step));
    return farthest(onward) > most ? VectorXd(onward * (most / farthest(onward))) : onward;
  }
  /// True if the last changes do not add up, as those of slow states would: rounding makes them.
  bool scatter_in(std::span<const VectorXd> changes) const {
    constexpr std::size_t few = 3, most = 6;
    if (changes.size() < few) return false;
    VectorXd sum = VectorXd::Zero(z_.size());
    double sizes = 0;
    for (const auto& change : changes.last(std::min(most, changes.size())))
      sum += change, sizes += map_.size_of_step(change, z_);
    return map_.size_of_step(sum, z_) < 0.5 * sizes;
  }
  /// True if small changes of the last periods have not led away from where they began, as slow ones of one sign do.
  bool go_nowhere() const {
    constexpr std::size_t periods = 8;
    constexpr double small = 1e-2, nowhere = 3;
    if (onsets_.size() < periods) return false;
    double largest = 0, farthest = 0;
    for (std::size_t i = onsets_.size() - periods; i < onsets_.size(); ++i) {
      largest = std::max(largest, map_.size_of_step(changes_[i], onsets_[i]));
      farthest = std::max(farthest, map_.size_of_step(onsets_.back() - onsets_[i], onsets_.back()));
    }
    return largest < small && farthest < nowhere * map_.size_of_step(changes_.back(), onsets_.back());
  }

  OnsetMap& map_;
  VectorXd z_;
  std::vector<VectorXd> onsets_, changes_;  ///< of the last periods, as long as they belong together
  int k_ = 0;                               ///< the number of the period that begins at z
  double now_ = 0, change_ = infinity, change_before_ = infinity;  ///< of the last periods, relative
  VectorXd onward_;                                                ///< where the last ones lead
  std::size_t together_ = 0;                                       ///< number of periods since a leap
  bool scatters_ = false, comes_in_slowly_ = false, settled_ = false, no_nearer_ = false;
  double closest_ = infinity;  ///< change of a period that no leap has made larger yet
  VectorXd closest_image_;     ///< the onset that ends it
  double nearest_ = infinity;  ///< smallest change so far
  int nearest_at_ = 0;
  int leapt_at_ = -1;   ///< the period before a leap that has not led closer yet
  int last_leap_ = -1;  ///< the period before it
  int plain_until_ = plain - 1, strays_ = 0;
  int turn_at_ = patience - 1;  ///< the period after which Newton's method is next asked
  int judged_at_ = -1;          ///< the period by which it must have led closer
};

OnsetMap::OnsetMap(const Model& model, double tolerance, double stick_threshold, Onset kind, int slips)
    : model_(model),
      system_(model),
      tolerance_(tolerance),
      stick_threshold_(stick_threshold),
      kind_(kind),
      slips_(slips) {
  std::vector<double> s(system_.size());
  const std::vector<double> rest(system_.size());
  system_.scale(rest.data(), s.data());
  if (kind == Onset::reversed) {
    returning_.push_back(displacement);
    s[displacement] = model.drive.speed.level() * std::sqrt(model.slider.mass / model.slider.stiffness);
  }
  for (int i = mechanical; i < system_.size(); ++i) returning_.push_back(i);
  scale_ = gather(s);
}

StickSlipPeriod OnsetMap::cycle(const std::vector<double>* reversed) {
  auto period = stick_slip_period(model_, tolerance_, stick_threshold_, reversed, 1, kind_);
  if (!period.found || scale_.size() == 0) return period;  // without memory stick forgets the past
  long steps = period.steps, evaluations = period.evaluations;
  constexpr long most_steps = longest_period;
  Search search(*this, gather(period.onset));
  while (search.goes_on() && steps < most_steps) {
    constexpr long alike = 20, few = 1000;  // steps: a period that takes many more is of another kind
    StickSlipPeriod next = period_from(search.onset(), search.led() ? alike * period.steps + few : most_steps);
    steps += next.steps, evaluations += next.evaluations;
    if (!next.found && search.led()) {
      search.stray();
      continue;
    }
    const Metrics before = std::exchange(period, std::move(next)).metrics;
    if (!period.found) return period;
    search.add(gather(period.onset));
    if (search.has_arrived(period)) {
      if (fewer_slips_do(search.onset(), 1e3 * search.known())) {
        search.begin_anew(search.onset());
        continue;
      }
      const double open = search.open(largest_change(before, period.metrics));
      if (search.may_be_short())
        period = closer(std::move(period), search.onset(), open, steps, evaluations);
      else
        period.closure += open;
      period.steps = steps, period.evaluations = evaluations, period.slips = slips_;
      period.turned = search.turned();
      return period;
    }
    if (const int kinds = slips_ == 1 ? search.alternating() : 1; kinds > 1) {
      slips_ = kinds;
      search.begin_anew(search.onset() + search.change());
    } else if (search.asks_for_newton()) {
      steps += 2 * scale_.size() * period.steps;  // about
      search.turn(newton_step(search.onset(), search.change()));
    } else {
      search.go_on();
    }
  }
  period.found = false;
  period.outcome = {Ending::budget_spent, "stick and slip do not come to repeat themselves"};
  return period;
}

std::vector<std::complex<double>> OnsetMap::multipliers(const std::vector<double>& onset, double share) const {
  if (scale_.size() == 0) return {0.0};
  const MatrixXd D = derivative(gather(onset), share);
  if (!D.allFinite()) return {};
  return by_modulus(D);
}

VectorXd OnsetMap::gather(const std::vector<double>& y) const {
  VectorXd z(returning_.size());
  for (std::size_t k = 0; k < returning_.size(); ++k) z[k] = y[returning_[k]];
  return z;
}

VectorXd OnsetMap::sizes_at(const VectorXd& z) const {
  VectorXd sizes = z.cwiseAbs().cwiseMax(1e-12 * scale_);
  if (kind_ == Onset::reversed) sizes[0] = scale_[0];
  return sizes;
}

double OnsetMap::size_of_step(const VectorXd& step, const VectorXd& z) const {
  return step.cwiseQuotient(sizes_at(z)).norm();
}

double OnsetMap::scatter(const StickSlipPeriod& period) {
  std::vector<double> f(system_.size()), mass(system_.size());
  system_.set_mode(0, ContactMode::stick);
  system_.evaluate(0, period.onset.data(), f.data());
  system_.mass(0, mass.data());
  system_.set_mode(0, ContactMode::forward);
  VectorXd open(scale_.size());
  for (int k = 0; k < open.size(); ++k) open[k] = period.landing * f[returning_[k]] / mass[returning_[k]];
  return size_of_step(open, gather(period.onset));
}

double OnsetMap::largest_change(const Metrics& a, const Metrics& b) const {
  double largest = 0;
  for (const auto& metric : metric_names())
    largest = std::max(largest,
                       std::abs(a.*metric.member - b.*metric.member) / size_of(metric, b, model_.drive.speed.level()));
  return largest;
}

StickSlipPeriod OnsetMap::period_from(const VectorXd& z, long most_steps) const {
  std::vector<double> onset(system_.size());
  for (std::size_t k = 0; k < returning_.size(); ++k) onset[returning_[k]] = z[k];
  if (kind_ == Onset::held) onset = system_.loaded_at_rest(system_.observe(0, onset.data()).state, 1);
  return stick_slip_period(model_, tolerance_, stick_threshold_, &onset, slips_, kind_, most_steps);
}

MatrixXd OnsetMap::derivative(const VectorXd& z, double share) const {
  const int n = int(z.size());
  MatrixXd D = MatrixXd::Zero(n, n), unknown = MatrixXd::Constant(n, n, std::nan(""));
  const double part = share * std::max(1e-4, 100 * tolerance_);
  constexpr long most_steps = 400'000;
  long steps = 0;
  for (int k = 0; k < n; ++k) {
    const double h = part * sizes_at(z)[k];
    const auto right = period_from(z + h * VectorXd::Unit(n, k)), left = period_from(z - h * VectorXd::Unit(n, k));
    steps += right.steps + left.steps;
    if (!right.found || !left.found || steps > most_steps) return unknown;
    D.col(k) = (gather(right.onset) - gather(left.onset)) / (2 * h);
  }
  return D;
}

std::optional<VectorXd> OnsetMap::newton_step(const VectorXd& z, const VectorXd& step) const {
  const VectorXd sizes = sizes_at(z);
  const MatrixXd D = sizes.cwiseInverse().asDiagonal() * derivative(z) * sizes.asDiagonal();
  if (!D.allFinite()) return std::nullopt;
  VectorXd onward = solve_linear(MatrixXd::Identity(z.size(), z.size()) - D, step.cwiseQuotient(sizes));
  if (!onward.allFinite()) return std::nullopt;
  constexpr double most = 0.5;
  onward = onward.cwiseMax(-most);
  return VectorXd(onward.cwiseProduct(sizes));
}

StickSlipPeriod OnsetMap::closer(StickSlipPeriod period, VectorXd z, double open, long& steps,
                                 long& evaluations) const {
  constexpr double farthest = 0.5, last_digits = 1e-15;
  double way = infinity, times = 1;  // what is left; and by how much more metrics change
  while (const auto turn = newton_step(z, gather(period.onset) - z)) {
    steps += 2 * z.size() * period.steps;  // about
    const double left = size_of_step(*turn, z);
    const bool leads = left < std::min(0.5 * way, farthest);
    way = std::min(left, way);
    if (!leads || way < last_digits) break;
    auto next = period_from(z + *turn);
    steps += next.steps, evaluations += next.evaluations;
    if (!next.found) break;
    times = std::max(times, largest_change(period.metrics, next.metrics) / left);
    z += *turn;
    period = std::move(next);
  }
  period.closure += way < infinity ? times * way : open;
  return period;
}

bool OnsetMap::fewer_slips_do(const VectorXd& z, double same) {
  const int all = slips_;
  for (slips_ = 1; slips_ < all; ++slips_) {
    if (all % slips_ != 0) continue;
    const auto period = period_from(z);
    if (period.found && size_of_step(gather(period.onset) - z, z) < same) return true;
  }
  slips_ = all;
  return false;
}

}  // namespace rosin::analysis::cycles
