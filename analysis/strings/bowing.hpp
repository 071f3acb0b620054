/// Bowed strings followed in time, as many at once as lanes hold.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "analysis/strings/transient.hpp"
#include "core/error.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::analysis::strings {

using oscillators::BowedStringModel;

/// How long a string is bowed.
struct BowingOptions {
  double duration = 0;        ///< s; 0: until `periods_after` the first slip
  double periods_after = 31;  ///< in periods of the open string
  double patience = 36;       ///< periods after twice the time at which slip is due, when it has not come
  TransientOptions transient = {};
  bool keep_slips = true;  ///< in results; planes do without
};

/// What has become of one string.
struct Bowing {
  Transient transient;
  std::vector<SlipEpisode> raw;  ///< every slip, however short
  double first_slip;             ///< s
  double bridge_force;           ///< peak to peak over the last periods, N
  long samples;
  Outcome outcome;  ///< of a failure, the reason
};

/// The time (s) at which a bow that accelerates evenly from rest first slips, if the string follows it without waves;
/// NaN for other gestures.
double first_slip_of_slow_bow(const BowedStringModel&);

/// One string.
Bowing bow(const BowedStringModel&, const BowingOptions&);
/// Many; strings alike sound together. Results do not depend on the number of threads.
/// \param finished  called with places among the models, from one thread at a time
std::vector<Bowing> bow(std::span<const BowedStringModel>, const BowingOptions&, int threads,
                        const std::function<void(std::size_t)>& finished = {});

/// Up to 32 strings of one kind, in stages one after another, each of options.duration: what becomes of a string in
/// each, told as if it began there.
std::vector<std::vector<Bowing>> bow_in_stages(std::span<const BowedStringModel>, const BowingOptions&, int stages);

/// The string sampled more finely, from whose motion errors of sampling are told.
BowedStringModel finer(BowedStringModel, double factor = 2);

/// Samples of one string at equal intervals, all where there are up to five million.
struct StringRecord {
  std::vector<double> time, bow_speed, velocity, friction, slip_rate, normal_load, bridge_force, nut_force, stick;
  std::vector<std::vector<double>> states;  ///< of the law, one list each, of the first contact
  std::vector<std::vector<double>> contact_velocity, contact_friction;  ///< where the bow has several
  std::vector<double> sound;                                            ///< force on the bridge at every sample, N
  std::vector<double> heard;                                            ///< by the response of a body, see hear()
  Bowing bowing;
};
StringRecord record(const BowedStringModel&, const BowingOptions&);
/// Fills `heard` at the times of the record, and sets `sound` to it at every sample: ∫ h(t) F(t' − t) dt of a response
/// h to an impulse of 1 N s on the bridge, with the force as linear between samples and as constant before the first.
/// Returns its root mean square about the mean over the last periods.
double hear(StringRecord&, const Signal::Table& response, const BowedStringModel&, int periods);

}  // namespace rosin::analysis::strings
