/// Slips that count, periods of Helmholtz motion, and regimes.
#include "analysis/strings/transient.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::analysis::strings {

const std::vector<std::string>& string_regime_names() {
  static const std::vector<std::string> names = {"none", "helmholtz", "double-slip", "irregular", "raucous", "sliding"};
  return names;
}

Transient find_transient(const std::vector<SlipEpisode>& raw, long samples, double step, double seconds,
                         double bow_position, const TransientOptions& options) {
  const double period = seconds / step;  // in samples
  Transient result{NAN, options.most, StringRegime::none, 0, NAN, {}};
  if (raw.empty()) return result;
  result.first_slip = double(raw.front().on);
  auto& slips = result.slips;
  for (auto slip : raw) {
    if (slip.off < 0) slip.off = samples;
    if (!slips.empty() && double(slip.on - slips.back().off) < options.gap * period) {
      slips.back().off = slip.off;
      slips.back().distance += slip.distance;
    } else {
      slips.push_back(slip);
    }
  }
  std::erase_if(slips, [&](const SlipEpisode& slip) {
    return slip.distance < options.least * std::abs(slip.bow_speed) * seconds;
  });

  const auto is_helmholtz = [&](std::size_t k) {
    const double between = double(slips[k + 1].on - slips[k].on) / period;
    const double slipping = double(slips[k].off - slips[k].on) / (bow_position * period);
    return std::abs(between - 1) <= options.tolerance && slipping >= options.shortest && slipping <= options.longest;
  };
  int in_a_row = 0;
  for (std::size_t k = 0; k + 1 < slips.size(); ++k) {
    in_a_row = is_helmholtz(k) ? in_a_row + 1 : 0;
    if (in_a_row < options.periods) continue;
    const auto first = k + 1 - std::size_t(options.periods);
    result.length = std::min((double(slips[first].on) - result.first_slip) / period, options.most);
    break;
  }

  const double window = double(samples) - options.periods * period;
  const auto begin = std::size_t(
      std::ranges::find_if(slips, [&](const SlipEpisode& slip) { return double(slip.on) >= window; }) - slips.begin());
  const auto count = slips.size() - begin;
  result.slips_per_period = double(count) / options.periods;
  if (count >= 2) result.period = double(slips.back().on - slips[begin].on) / double(count - 1) / period;
  bool all = true;
  for (std::size_t k = begin; k + 1 < slips.size(); ++k) all = all && is_helmholtz(k);
  const double rate = result.slips_per_period;
  if (count == 0)
    result.regime = StringRegime::sliding;
  else if (all && int(count) >= options.periods - 2)
    result.regime = StringRegime::helmholtz;
  else if (rate >= 1.6 && rate <= 2.4)
    result.regime = StringRegime::double_slip;
  else if (rate >= 0.8 && rate < 1.6)
    result.regime = StringRegime::irregular;
  else
    result.regime = StringRegime::raucous;
  return result;
}

}  // namespace rosin::analysis::strings
