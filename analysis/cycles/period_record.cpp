/// Extremes of columns located at the full order of the steps, means by the quadrature of their nodes.
#include "analysis/cycles/period_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/steady/structure_stability.hpp"
#include "oscillators/profile.hpp"

namespace rosin::analysis::cycles {

using motion::Follower;
using oscillators::StructureSystem;
using solvers::steps::RadauTableau;

std::string metric_name(const std::string& column) {
  const std::string coefficient = "friction_coefficient";
  return column.starts_with(coefficient) ? "friction" + column.substr(coefficient.size()) : column;
}

PeriodRecord::PeriodRecord(const StructureSystem& system, double tolerance, double stick_threshold)
    : record(system), system_(system), steps_(record.names.size()) {
  for (int j = 0; j < system.friction_contacts(); ++j)
    if (!system.structure().contacts[j].frictionless()) {
      slips_.push_back(j);
      slip_.emplace_back(slip_seen(system, j), system.size(), tolerance, stick_threshold);
    }
  distance_.assign(slips_.size(), 0.0), wear_.assign(slips_.size(), 0.0);
  high_.assign(record.names.size(), -infinity), low_.assign(record.names.size(), infinity);
  mean_.assign(record.names.size(), 0.0);
  stick_.assign(system.contacts(), 0.0);
  force_.resize(system.friction_contacts());
}

void PeriodRecord::add(Follower::Step& step, std::span<const Follower::Event> switches) {
  const auto& tableau = RadauTableau::get();
  constexpr int nodes = Follower::Step::stages + 1;
  std::vector<double> y(system_.size()), row;
  if (time.empty()) time.push_back(0), record.record(step.time_before(), step.state_before().data());
  for (int node = 0; node < nodes; ++node) {
    const double t = node == 0 ? step.time_before() : step.stage_time(node - 1);
    if (node == 0)
      y = step.state_before();
    else
      step.stage(node - 1, y.data());
    record.observe(t, y.data(), row);
    for (std::size_t c = 0; c < row.size(); ++c) steps_[c][node] = row[c];
    if (node == 0) continue;
    for (std::size_t c = 0; c < row.size(); ++c) mean_[c] += tableau.b[node - 1] * step.length() * row[c];
    for (std::size_t k = 0; k < slips_.size(); ++k)
      wear_[k] += tableau.b[node - 1] * step.length() * wear_rate(slips_[k], t, y.data());
    system_.friction_forces(t, y.data(), force_.data());
    for (int j = 0; j < system_.friction_contacts(); ++j)
      heat_ += tableau.b[node - 1] * step.length() * force_[j] * system_.slip_rate(j, t, y.data());
  }
  for (std::size_t c = 0; c < steps_.size(); ++c) {
    for (const double value : steps_[c]) high_[c] = std::max(high_[c], value), low_[c] = std::min(low_[c], value);
    Between between;
    for (int i = 0; i <= parts; ++i) between[i] = tableau.interpolate(steps_[c], double(i) / parts);
    high_[c] = std::max(high_[c], look_between(step, c, between, +1));
    low_[c] = std::min(low_[c], -look_between(step, c, between, -1));
  }
  for (int c = 0; c < system_.contacts(); ++c)
    if (system_.mode(c) == ContactMode::stick) stick_[c] += step.length();
  add_slip(step);
  length_.push_back(step.length());
  for (int node = 1; node < nodes; ++node) {
    time.push_back(moment_ + step.node(node - 1) * step.length());
    for (std::size_t c = 0; c < steps_.size(); ++c) record.values[c].push_back(steps_[c][node]);
  }
  moment_ += step.length();
  for (const auto& event : switches) {
    events.push_back(motion::event_of(system_, event));
    events.back().time = moment_ + (event.time - step.time());
  }
}

/// The largest value of `sign` times a column within the step, at the full order, where it is above what is known.
double PeriodRecord::look_between(Follower::Step& step, std::size_t column, const Between& between, double sign) {
  const auto& tableau = RadauTableau::get();
  const auto by_polynomial = [&](double theta) { return sign * tableau.interpolate(steps_[column], theta); };
  double at = 0, largest = sign * between[0];
  for (int i = 1; i <= parts; ++i)
    if (const double value = sign * between[i]; value > largest) at = double(i) / parts, largest = value;
  const double known = sign > 0 ? high_[column] : -low_[column];
  const double range = *std::ranges::max_element(steps_[column]) - *std::ranges::min_element(steps_[column]);
  constexpr double counts = 1e-13, inwards = 1e-4;
  // Towards an end of the step the column may rise up to that end, or to an extreme just before it.
  if (at == 0 && by_polynomial(inwards) <= largest) return known;
  if (at == 1 && by_polynomial(1 - inwards) <= largest) return known;
  if (!(largest + 0.1 * range > known + counts * std::abs(known))) return known;
  double left = std::max(at - 1.0 / parts, 0.0), right = std::min(at + 1.0 / parts, 1.0);
  for (int i = 0; i < 30; ++i) {
    const double a = left + (right - left) / 3, b = right - (right - left) / 3;
    if (by_polynomial(a) > by_polynomial(b))
      right = b;
    else
      left = a;
  }
  std::vector<double> y(system_.size()), row;
  const auto exactly = [&](double theta) {
    step.solve_at(theta, y.data());
    record.observe(step.time_at(theta), y.data(), row);
    return sign * row[column];
  };
  double theta = 0.5 * (left + right), best = exactly(theta);
  for (const double aside : {1e-2, 1e-2, 1e-3}) {  // vertices of parabolas
    const double centre = std::clamp(theta, aside, 1 - aside), a = exactly(centre - aside), b = exactly(centre),
                 c = exactly(centre + aside), bend = a - 2 * b + c;
    best = std::max({best, a, b, c});
    if (!(bend < 0)) break;
    theta = std::clamp(centre + 0.5 * aside * (a - c) / bend, 0.0, 1.0);
    best = std::max(best, b - 0.125 * (a - c) * (a - c) / bend);
  }
  return std::max(best, known);
}

/// N |v| of a contact (W).
double PeriodRecord::wear_rate(int j, double t, const double* y) const {
  return system_.normal_load(j, t, y) * std::abs(system_.contact_slip_rate(j, t, y));
}

void PeriodRecord::add_slip(Follower::Step& step) {
  for (std::size_t k = 0; k < slip_.size(); ++k) {
    const auto column = [&](const char* name) {
      const auto& names = record.names;
      return std::size_t(std::ranges::find(names, motion::numbered(system_, name, slips_[k])) - names.begin());
    };
    const auto samples = slip_[k].samples(step);
    const auto extrema = SlipRecord::extrema(samples, &SlipRecord::Sample::slip_rate);
    slip_[k].add(step, samples, extrema, high_[column("slip_rate")], high_[column("friction_coefficient")]);
    distance_[k] += step.length() * SlipRecord::distance(samples, extrema);
  }
}

void PeriodRecord::add_metric(std::string name, double value, std::string unit, std::string meaning) {
  metrics[std::move(name)] = {value, infinity, std::move(unit), std::move(meaning)};
}

/// Time at rest and at low slip rates, distance slipped and loop of a contact with friction.
void PeriodRecord::add_slip_metrics(int k, double duration) {
  const int j = slips_[k];
  const auto add = [&](const char* name, double value, const char* unit, const char* meaning) {
    add_metric(motion::numbered(system_, name, j), value, unit, meaning);
  };
  const auto& slip = slip_[k];
  double stuck = slip.time_within[0];
  for (int c = 0; c < system_.contacts(); ++c)
    if (system_.friction_contact(c) == j) stuck = stick_[c];
  add("stick_fraction", stuck / duration, "1",
      "part of the period at rest, or with |v| <= threshold * V if none rests");
  add("slow_fraction", slip.time_within[0] / duration, "1", "part of the period with |v| <= threshold * V");
  add("stick_fraction_001", slip.time_within[1] / duration, "1", "part of the period with |v| <= 0.01 V");
  add("stick_fraction_05", slip.time_within[2] / duration, "1", "part of the period with |v| <= 0.5 V");
  add("slip_distance", distance_[k], "m", "distance slipped in a period");
  add("wear_work_rate", wear_[k] / duration, "W", "mean of load times slip rate");
  const bool backwards = system_.structure().contacts[j].speed.level() < 0;
  const auto largest = [&](const char* name) {
    const auto of = motion::numbered(system_, name, j);
    return backwards ? -metrics.at(of + "_min").value : metrics.at(of + "_max").value;
  };
  const double area = std::abs(slip.loop_integral());
  add("loop_area", area, "m/s", "area enclosed by the friction-velocity loop");
  add("loop_area_normalised", area > 0 ? area / (largest("slip_rate") * largest("friction")) : 0, "1",
      "loop area over largest slip rate and friction");
}

std::vector<PeriodRecord::Place> PeriodRecord::places(double duration) const {
  constexpr double finest = 0.03;  // rad of the fundamental, that a part of a step may last
  constexpr std::array<std::pair<double, double>, 3> gauss = {
      {{0.5 - 0.3872983346207417, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + 0.3872983346207417, 5.0 / 18}}};
  const double turn = 2 * std::numbers::pi / duration;
  std::vector<Place> places;
  double begin = 0;
  for (std::size_t s = 0; s < length_.size(); ++s) {
    const int parts = std::max(1, int(std::ceil(turn * length_[s] / finest)));
    for (int p = 0; p < parts; ++p)
      for (const auto& [place, weight] : gauss) {
        const double theta = (p + place) / parts;
        places.push_back({s, theta, weight / parts * length_[s], std::polar(1.0, turn * (begin + theta * length_[s]))});
      }
    begin += length_[s];
  }
  return places;
}

/// q = mean + Σ A_n cos(n ω t + φ_n) with ω = 2π/duration. Under a periodic drive t is its time; else φ_1 = 0.
void PeriodRecord::add_harmonics(int i, double duration, const std::vector<Place>& places) {
  constexpr int most = 9;
  const auto& name = record.names[i];
  const auto& unit = record.units[i];
  const auto& tableau = RadauTableau::get();
  const double mean = mean_[i] / duration;
  std::complex<double> sums[most + 1] = {};
  std::vector<double> values;
  for (const auto& at : places) {
    std::array<double, RadauTableau::stages + 1> nodes;
    std::copy_n(record.values[i].begin() + std::ptrdiff_t(at.step * RadauTableau::stages), nodes.size(), nodes.begin());
    values.push_back(tableau.interpolate(nodes, at.theta) - mean);
    std::complex<double> part = 2 / duration * at.weight * values.back();
    for (int n = 1; n <= most; ++n) sums[n] += part *= std::conj(at.turned);
  }
  double square = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double rest = values[k] - (sums[1] * places[k].turned).real();
    square += 2 / duration * places[k].weight * rest * rest;
  }
  const double fundamental = std::abs(sums[1]);
  for (int n = 1; n <= most; ++n) {
    const double shift = system_.structure().constant() ? n * std::arg(sums[1]) : 0;
    add_metric(fmt::format("{}_harmonic_{}", name, n), std::abs(sums[n]), unit,
               fmt::format("amplitude of harmonic {} of {}", n, name));
    add_metric(fmt::format("{}_phase_{}", name, n), std::remainder(std::arg(sums[n]) - shift, 2 * std::numbers::pi),
               "rad", fmt::format("phase of harmonic {} of {}, of cos", n, name));
  }
  add_metric(name + "_distortion", fundamental > 0 ? std::sqrt(square) / fundamental : 0, "1",
             fmt::format("total harmonic distortion of {}", name));
}

void PeriodRecord::stand(const double* y) {
  record.observe(0, y, mean_);
  for (std::size_t k = 0; k < slips_.size(); ++k) wear_[k] = wear_rate(slips_[k], 0, y);
  high_ = low_ = mean_;
}

void PeriodRecord::finish(double duration) {
  add_metric("period", duration, "s", "period of the motion");
  for (std::size_t c = 0; c < record.names.size(); ++c) {
    const auto name = metric_name(record.names[c]);
    std::string words = name;
    std::ranges::replace(words, '_', ' ');
    const auto add = [&](const char* end, double value, const char* of) {
      add_metric(name + end, value, record.units[c], of + words);
    };
    add("_max", high_[c], "largest "), add("_min", low_[c], "smallest ");
    add("_amplitude", 0.5 * (high_[c] - low_[c]), "half the range of "), add("_mean", mean_[c] / duration, "mean ");
  }
  coordinate_max.assign(high_.begin(), high_.begin() + system_.coordinates());
  coordinate_min.assign(low_.begin(), low_.begin() + system_.coordinates());
  const auto over_period = places(duration);
  for (int i = 0; i < system_.coordinates(); ++i) add_harmonics(i, duration, over_period);
  for (std::size_t k = 0; k < slip_.size(); ++k) add_slip_metrics(int(k), duration);
  for (const int j : slips_)
    if (system_.follows_motion(j))
      add_metric(motion::numbered(system_, "apparent_friction", j),
                 metrics.at(motion::numbered(system_, "friction_force", j) + "_mean").value /
                     metrics.at(motion::numbered(system_, "normal_load", j) + "_mean").value,
                 "1", "mean friction over mean load");
  add_friction_drops();
  add_metric("friction_work", heat_, "J", "heat of friction in a period");
}

/// What the mean friction of contacts on profiles has lost against steady sliding on their mean level, where there is
/// any.
void PeriodRecord::add_friction_drops() {
  const auto& structure = system_.structure();
  const auto rides = [&](int j) { return oscillators::profile_under(structure.contacts[j].normal_law.get()); };
  if (std::ranges::none_of(slips_, rides)) return;
  std::vector<double> on_level(force_.size());
  try {
    StructureSystem level(steady::frozen(structure));
    level.slide();
    level.friction_forces(0, level.steady(0).data(), on_level.data());
  } catch (const oscillators::NoSteadySliding&) {
    return;
  }
  for (const int j : slips_)
    if (rides(j) && on_level[j] != 0)
      add_metric(motion::numbered(system_, "friction_drop", j),
                 1 - metrics.at(motion::numbered(system_, "friction_force", j) + "_mean").value / on_level[j], "1",
                 "1 - mean friction over that of steady sliding on the mean level of the profile");
}

std::map<std::string, double> metrics_of_sliding(const oscillators::Structure& structure) {
  StructureSystem system(steady::frozen(structure));
  system.slide();
  PeriodRecord record(system);
  record.stand(system.steady(0).data());
  record.finish(1);
  std::map<std::string, double> values;
  for (const auto& [name, measure] : record.metrics) {
    const bool of_period = name == "period" || name == "friction_work" || name.starts_with("slip_distance") ||
                           name.find("_phase_") != std::string::npos || name.ends_with("_distortion");
    if (!of_period) values[name] = measure.value;
  }
  for (int j = 0; j < system.friction_contacts(); ++j)
    if (oscillators::profile_under(structure.contacts[j].normal_law.get()) && !structure.contacts[j].frictionless())
      values[motion::numbered(system, "friction_drop", j)] = 0;
  return values;
}

}  // namespace rosin::analysis::cycles
