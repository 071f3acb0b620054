/// Profiles as sums of waves, and what contacts see of them at a time.
#include "oscillators/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <typeinfo>

#include "core/fourier.hpp"
#include "core/random.hpp"

namespace rosin::oscillators {

namespace {
constexpr double whole_turn = 2 * std::numbers::pi;
}

double Profile::height(double x) const {
  double sum = 0;
  for (const auto& wave : waves) sum += wave.amplitude * std::cos(whole_turn * x / wave.wavelength + wave.phase);
  return sum;
}

double Profile::rms() const {
  double sum = 0;
  for (const auto& wave : waves) sum += wave.amplitude * wave.amplitude / 2;
  return std::sqrt(sum);
}

bool Profile::is_flat() const {
  return std::ranges::all_of(waves, [](const Wave& wave) { return wave.amplitude == 0; });
}

Profile profile_of(const RoughTrack& track) {
  constexpr double rounding = 1e-9;  // a wavelength that is the length over a whole number counts
  const double first = std::ceil(track.length / track.longest * (1 - rounding)),
               last = std::floor(track.length / track.shortest * (1 + rounding));
  if (last < first)
    throw InputError(fmt::format(
        "no wave fits into the track a whole number of times: its length of {:.6g} m over whole numbers has no value "
        "from {:.6g} m to {:.6g} m (shortest to longest wavelength)",
        track.length, track.shortest, track.longest));
  if (last - first >= most_waves)
    throw InputError(
        fmt::format("the track of {:.6g} m has {:.0f} waves from {:.6g} m to {:.6g} m, more than {}; shorten its "
                    "length, or raise the shortest wavelength",
                    track.length, last - first + 1, track.shortest, track.longest, most_waves));
  Profile profile;
  const std::uint64_t begin = splitmix(track.seed + splitmix_step);
  for (double n = first; n <= last; ++n) {
    const double phase = whole_turn * open_unit(splitmix(begin + std::uint64_t(n) * splitmix_step));
    profile.waves.push_back({std::pow(n / first, -track.hurst - 0.5), track.length / n, phase});
  }
  const double factor = track.rms / profile.rms();
  for (auto& wave : profile.waves) wave.amplitude *= factor;
  return profile;
}

Profile profile_of(std::span<const double> heights, double spacing) {
  const int n = int(heights.size());
  RealTransform transform(n);
  std::ranges::copy(heights, transform.record().begin());
  const auto bins = transform();
  Profile profile;
  double largest = 0;
  for (int k = 1; k < transform.bins(); ++k) {
    const bool is_alone = 2 * k == n;  // the highest of an even number: its conjugate is itself
    const double amplitude = (is_alone ? 1 : 2) * std::abs(bins[k]) / n;
    profile.waves.push_back({amplitude, n * spacing / k, std::arg(bins[k])});
    largest = std::max(largest, amplitude);
  }
  double highest = 0;
  for (const double h : heights) highest = std::max(highest, std::abs(h));
  if (largest <= 1e-14 * highest) throw InputError("the heights of the track are all the same, so that it is flat");
  constexpr double rounding = 1e-12;
  std::erase_if(profile.waves, [&](const auto& wave) { return wave.amplitude <= rounding * largest; });
  return profile;
}

OverProfile::OverProfile(std::shared_ptr<const NormalLaw> law, const Profile& profile, const Signal& speed,
                         std::vector<double> ahead)
    : law_(std::move(law)), stations_(int(ahead.size())), is_flat_(profile.is_flat()) {
  static std::atomic<std::uint64_t> made = 0;
  number_ = ++made;
  if (!speed.constant() || speed.level() == 0)
    throw InputError(
        "a profile is ridden over at a constant speed that is not 0, which makes its height under the contact a "
        "function of time: the distance along it is the speed times time (speed of the surface, m/s)");
  constexpr double somewhat = 1e-6;  // m
  if (const auto answer = law_->at(somewhat, 0, 1); answer.pressure_by_approach == 0 && answer.pressure_by_rate == 0)
    throw InputError("no height changes the load of a contact without stiffness and damping along its normal (N/m)");
  Signal::Harmonics terms{0, {}};
  for (const auto& wave : profile.waves)
    terms.terms.push_back({wave.amplitude, whole_turn * speed.level() / wave.wavelength, wave.phase});
  for (const double distance : ahead)
    for (const auto& wave : profile.waves) {
      const double phase = whole_turn * distance / wave.wavelength;
      cosine_.push_back(std::cos(phase)), sine_.push_back(std::sin(phase));
    }
  waves_ = terms.terms;
  height_ = Signal(std::move(terms));
}

/// All stations of a contact, and all its answers of one evaluation, are asked for at the same time: the heights of the
/// last one stay.
OverProfile::Height OverProfile::under(int station, double t) const {
  thread_local struct {
    std::uint64_t number = 0;
    double t = 0;
    std::vector<Height> heights;
  } last;
  if (last.number != number_ || last.t != t) {
    last.number = number_, last.t = t;
    last.heights.assign(stations_, {0, 0});
    const std::size_t count = waves_.size();
    for (std::size_t w = 0; w < count; ++w) {
      const auto& [amplitude, frequency, phase] = waves_[w];
      const double angle = frequency * t + phase, c = amplitude * std::cos(angle), s = amplitude * std::sin(angle);
      for (std::size_t i = 0; i < last.heights.size(); ++i) {
        const double ahead_c = cosine_[i * count + w], ahead_s = sine_[i * count + w];
        last.heights[i].level += c * ahead_c - s * ahead_s;
        last.heights[i].rate -= frequency * (s * ahead_c + c * ahead_s);
      }
    }
  }
  return last.heights[station];
}

const OverProfile* profile_under(const NormalLaw* law) {
  return law && typeid(*law) == typeid(OverProfile) ? static_cast<const OverProfile*>(law) : nullptr;
}

}  // namespace rosin::oscillators
