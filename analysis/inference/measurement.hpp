/// What a model says to a measurement, and how that changes with its numbers: frequency responses, steady curves,
/// velocity steps, holds, events of stick–slip, friction recorded while the slip rate or the load point moves in any
/// way, and the recorded motion of a machine.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/inference/machine.hpp"
#include "analysis/inference/recorded_motion.hpp"
#include "analysis/inference/rest.hpp"

namespace rosin::analysis::inference {

/// One set of numbers, each with its standard error.
struct Measurement {
  enum class Kind {
    frequency_response,  ///< x: Hz; y: real and imaginary part of Z in turn, N s/m
    velocity_step,       ///< x: s or m, as `over`; y: friction coefficient under an imposed slip rate that jumps
    steady_curve,        ///< x: m/s; y: friction coefficient
    hold,                ///< x: s that the drive rests; y: peak coefficient as it resumes, behind the contact's spring
    record,              ///< x: s; y: friction coefficient or force under the motion of `history`
    motion,              ///< x: s; y: `column` of the motion of `machine`
    stick_slip,          ///< x: drive speed, m/s; y: `event` of the stick–slip of the slider, or of `machine`
  };
  Kind kind = Kind::frequency_response;
  std::string name;
  double slip_rate = 1;             ///< mean, before the step, or around the hold, m/s
  double next_slip_rate = 1;        ///< after the step, m/s
  double normal_load = 1;           ///< N
  std::vector<double> x, y, error;  ///< `error` empty: a fit finds size and correlation of the noise from the residuals

  /// The motion behind a step: over time or over the displacement that is imposed.
  enum class Over { time, displacement };
  struct Step {
    double at;         ///< s or m, as x
    double slip_rate;  ///< m/s, from there on
  };
  Over over = Over::time;
  double step_at = 0;            ///< of a velocity step, s or m
  std::vector<Step> later = {};  ///< further steps, in their order
  /// The motion of a record: slip rate just behind each of these times, and load, with straight lines between them.
  struct History {
    std::vector<double> time, slip_rate, normal_load;
    /// Of a smooth record: between two times the slip rate is the parabola that has its ends and its mean.
    RecordedMotion recorded = {};
    double slip_rate_noise = 0;          ///< m/s, where the slip rate was recorded, and not displacement
    std::vector<std::size_t> gaps = {};  ///< times behind which rows are missing
    Rest rest = {};  ///< its states one for each time, or none: at rest is then where the slip rate is 0

    bool rests(std::size_t i) const { return !rest.state.empty() && rest.state[i]; }
    bool smooth() const { return !recorded.displacement.empty(); }
    /// Slip rate just before a time.
    double before(std::size_t i) const { return smooth() ? recorded.before[i] : slip_rate[i]; }
    /// Of a smooth record: with another draw of the errors of what was recorded.
    History again(std::uint64_t seed) const;
    /// With another motion while rows are missing: at the slip rate before, or that behind; at the mean one where
    /// displacement was recorded.
    History across(bool as_behind) const;
  };
  History history = {};
  bool in_force = false;  ///< y of a record in N
  /// Of a motion or of stick–slip: one of the subject's. None: stick–slip is that of the model's slider.
  std::optional<std::size_t> machine = {};
  std::string column, unit;  ///< of a motion, as a run calls it
  /// What was read off each slip event.
  enum class Event {
    recurrence,      ///< s, from one event to the next
    force_drop,      ///< N, fall of the spring's force in it
    peak_slip_rate,  ///< m/s
    force_range      ///< N, from the highest to the lowest force of the spring, which goes on rising as slip begins
  };
  Event event = Event::recurrence;

  /// What a laboratory adds to the friction of a law; a fit finds each that is true, or not none.
  struct Terms {
    enum class Trend { none, time, displacement };
    Trend trend = Trend::none;  ///< a straight line that is 0 at the (first) step or the begin of the record
    bool base = false;          ///< a level
    bool clock_offset = false;  ///< by so much later than x says the motion took place
  };
  Terms terms = {};

  /// Points of a response have two numbers.
  bool pairs() const { return kind == Kind::frequency_response; }
  /// A series in time, of which a neighbour's noise may know something.
  bool series() const { return imposed() || kind == Kind::motion; }
  /// A series under a slip rate that is imposed.
  bool imposed() const { return kind == Kind::velocity_step || kind == Kind::record; }
  std::string unit_of_y() const { return kind == Kind::motion ? unit : in_force ? "N" : "1"; }
};

/// The model's y of a measurement, and ∂y/∂p of each number asked for.
struct Prediction {
  std::vector<double> y;
  std::vector<std::vector<double>> slopes;  ///< by number, then by y
  std::vector<double> by_clock = {};        ///< ∂y/∂(clock offset), where the measurement has that term
  /// True of each point at rest under a law that sticks: friction is then any up to a limit either way, and y the
  /// limit.
  std::vector<char> bounded = {};
  std::vector<double> slip_rate = {};  ///< of a motion, m/s, at each x; empty where no contact slips
  long steps = 0;                      ///< of the motion
};

/// What a model says to a measurement's x, as its y, with slopes by the numbers at `paths`: exact for responses and
/// steady curves; motion and its variational equations by collocation at 1e-10 for steps, holds and records.
/// Of the motion of a machine: analysis/inference/machine_motion.hpp.
/// \param clock_offset s or m, as x: the motion is later than x says. Trend and base are not in it.
/// \throws InputError where the law does not answer, and where no slope exists (analysis/response/contact_slopes.hpp).
Prediction predict(const Subject&, const Measurement&, const std::vector<std::string>& paths = {},
                   double clock_offset = 0);

/// Of a step or a record at each x: m that were imposed since the first step or the begin; empty for others.
std::vector<double> imposed_displacement(const Measurement&);

/// Of a step or a record at each x: the slip rate and the load that are imposed, m/s and N.
std::vector<double> imposed_slip_rate(const Measurement&);
std::vector<double> imposed_normal_load(const Measurement&);

/// What a trend is multiplied by at each x: s since the first step or the begin of the record, or m of displacement.
std::vector<double> trend_abscissa(const Measurement&);

}  // namespace rosin::analysis::inference
