/// What a bowed string does: its slips, how long it takes to one slip a period, and which motion it ends in.
#pragma once
#include <string>
#include <vector>

namespace rosin::analysis::strings {

/// From the sample at which slip begins to that at which it ends.
struct SlipEpisode {
  long on, off;
  double distance;   ///< that bow and string have slid past each other, m
  double bow_speed;  ///< at its beginning, m/s
};

/// Motions of a bowed string, over its last periods.
enum class StringRegime { none, helmholtz, double_slip, irregular, raucous, sliding };
const std::vector<std::string>& string_regime_names();

/// What counts as one slip, and as a period of Helmholtz motion.
struct TransientOptions {
  double gap = 0.05;       ///< slips closer than this are one, in periods
  double least = 0.2;      ///< slip over shorter distances is none, in distances that the bow moves in a period
  double tolerance = 0.1;  ///< of a period, relative
  double shortest = 0.3, longest = 3;  ///< slip of a Helmholtz period, in β periods
  int periods = 8;                     ///< in a row; as many at the end make the regime
  double most = 20;                    ///< transients of this length or longer are not told apart, in periods
};

struct Transient {
  double first_slip;  ///< sample, NaN where there is none
  double length;      ///< from the first slip to the first of enough Helmholtz periods, in periods; `most`: none
  StringRegime regime;
  double slips_per_period;         ///< over the last periods
  double period;                   ///< mean of those between slips there, over 1/f₀; NaN with fewer than two slips
  std::vector<SlipEpisode> slips;  ///< that count
};

/// \param raw      in their order; the last may have no end, off < 0
/// \param samples  of the record
/// \param step     from one to the next, s
/// \param period   1/f₀, s
Transient find_transient(const std::vector<SlipEpisode>& raw, long samples, double step, double period,
                         double bow_position, const TransientOptions& = {});

}  // namespace rosin::analysis::strings
