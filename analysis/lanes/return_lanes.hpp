/// The return map of many sliders at once, in SIMD lanes, without its derivative.
#pragma once
#include <array>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "oscillators/slider_lanes.hpp"
#include "solvers/lanes/ensemble.hpp"

namespace rosin::analysis::lanes {

/// The metrics that a return measures; the others cost nothing.
struct Recording {
  bool stick_fraction = false, slow_fraction = false, stick_fraction_001 = false, stick_fraction_05 = false;
  bool loop_area = false;
  bool extremes = false;  ///< extremes of slip rate and friction
  bool means = false;     ///< means of slip rate and friction
  double stick_threshold = 0.1;
};

/// One return to follow, from y to the next crossing of the section, with its result. The section is v = V with v
/// rising; under a set-valued law it is the onset of slip, where the drive has loaded a contact at rest to its limit.
struct LaneReturn {
  const oscillators::SliderSystem* slider = nullptr;
  std::array<double, solvers::lanes::Ensemble::capacity> y{};  ///< unknowns: start, then end, on the section
  double tolerance = 1e-6;
  double first_step = 0;          ///< s
  double growth_time = infinity;  ///< growth time of steady sliding, s; bounds steps near it
  double longest = infinity;      ///< longest duration of the return, s
  bool from_section = true;       ///< y lies on the section; else, under a set-valued law, at rest
  double dip = 1e-10;             ///< depth below V, over V, after which a rise through V counts
  bool record = false;
  std::size_t label = 0;  ///< identifies the task to its queue

  Ending ending = Ending::budget_spent;
  double duration = 0, amplitude = 0;  ///< s; largest |v − V|/V
  double last_step = 0;                ///< s, a first step for the next return
  long tries = 0;                      ///< step attempts
  cycles::Metrics metrics;             ///< if `record`
  bool touches_threshold =
      false;  ///< an extremum of ringing lies at a stick threshold: the time within it is ill-conditioned
};

/// Supplies returns to follow and takes back their results.
class ReturnQueue {
 public:
  virtual ~ReturnQueue() = default;
  /// The next return to follow, or nullptr if there is none at present.
  virtual LaneReturn* next() = 0;
  virtual void finished(LaneReturn&) = 0;
};

/// Follows returns of sliders with mass, 32 at a time; a lane that has finished one takes the next. Either all returns
/// of one ReturnLanes record or none, because lanes work in step.
class ReturnLanes {
 public:
  static constexpr long most_tries = 20'000;  ///< step attempts in one return

  /// True if lanes can follow this slider: it has mass and a constant drive; a set-valued law needs load, speed and
  /// spring too.
  static bool serves(const oscillators::SliderSystem&);
  /// `pattern`: any of the sliders; all must fit it (SliderLanes::fits).
  ReturnLanes(const oscillators::SliderSystem& pattern, const Recording&);
  /// Works until the queue is empty and all lanes are idle.
  void run(ReturnQueue&);
  bool fits(const oscillators::SliderSystem& slider) const { return sliders_.fits(slider); }

 private:
  enum class EventKind : std::int8_t { none, section, level, slip_rate_extreme, friction_extreme, stop, release };
  struct Event {
    EventKind kind = EventKind::none;
    int level = 0;
    double theta = 2;
  };
  static constexpr int most_levels = 3;
  struct Level {
    double factor;  ///< threshold over V
    double cycles::Metrics::*member;
  };
  struct Lane {
    LaneReturn* task = nullptr;
    const oscillators::SliderSystem* loaded = nullptr;
    double V = 0;
    Event target;  ///< event at which the next step ends
    double entered[most_levels] = {};
    long begun = 0;  ///< attempts before this return
    // For set-valued laws: time before the present mode, time in stick so far.
    double elapsed = 0, stuck = 0;
    bool may_graze = false;  ///< the choice between stick and slip is within the error (grazing)
  };

  bool take(int lane, ReturnQueue&);
  /// Packs up to the last lane with a task are worked on.
  void leave_idle_packs_out();
  /// The first event in the last step, for which it must be retaken; none if there is none.
  Event first_event(int lane);
  enum class Arrival { continues, retaken, finished, switched, given_up };
  /// Processes the last step of a flagged lane.
  Arrival follow(int lane);
  /// Handles the event that the last step was to end on.
  Arrival arrive(int lane);
  /// The first crossing of a stick threshold in the last step, if there is one.
  Event first_level_crossing(int lane);
  /// The end of stick or slip in the last step, if there is one.
  Event first_switch(int lane);
  void cross(int lane, int level, double moment);
  /// Moves the end of the last step to `theta` of it, with the integrals.
  void end_step_at(int lane, double theta);
  /// Begins the mode after one that has just ended. Finished at the section.
  Arrival change_mode(int lane);
  void begin_mode(int lane, double direction, const double* y);
  void bound_switching_steps();
  /// Flags the lanes whose last step may hold an event.
  void flag_events();
  void update_extremes();
  void end(int lane, ReturnQueue&);
  void measure_steps();
  void accumulate();
  void accumulate_at_nodes();
  double section_value(int lane, double theta) const;
  void interpolate(int lane, double theta, double* y) const;
  /// Unknowns of all lanes at each `theta` of the last step.
  template <std::size_t n>
  void interpolate(const double (&theta)[n], std::array<Lanes, solvers::lanes::Ensemble::capacity> (&y)[n]) const;
  double friction_at(int lane, double theta) const;
  /// Holding limit less holding force of a contact that sticks (N).
  double holding_margin(int lane, double theta) const;
  /// Time since the return began.
  double now(int lane) const { return lanes_[lane].elapsed + ensemble_.time(lane); }
  template <class Question>
  static Arrival give_up_on_input_error(Question);
  template <class F>
  static double bisect(F f, double low, double high);

  oscillators::SliderLanes sliders_;
  solvers::lanes::Ensemble ensemble_;
  Recording recording_;
  std::vector<Level> levels_;
  int friction_index_;
  bool rigid_;
  bool switches_;  ///< the law is set-valued
  std::array<Lane, lane_count> lanes_;
  int packs_ = lane_packs;  ///< in use
  // Idle lanes of packs in use compute too; their values are finite and without meaning.
  Lanes near_rest_{};          ///< decrease of the slip rate allowed in any step before a reversal; 0: no bound
  Lanes section_{}, creep_{};  ///< contact slip rate, and at the end of the last step taken
  Lanes slip_rate_slope_[2]{}, friction_slope_[2]{};  ///< at both ends of the step, by θ
  Lanes friction_[2]{};                               ///< at both ends of the step
  Lanes V_ = 1.0, floor_ = 0.0, growth_time_ = infinity, longest_ = infinity, thresholds_[most_levels]{};
  Lanes growth_floor_ = 1.0;  ///< slip rate above which growth out of stick is resolved
  // 1 or 0: has been below V; follows a return; the next step ends at an event; records; lies within a stick threshold.
  Lanes below_ = 0.0, active_ = 0.0, has_target_ = 0.0, records_ = 0.0, inside_[most_levels]{};
  // For set-valued laws: 1 or 0, slip has left the neighbourhood of rest where it began; a tenth of the swing time (s);
  // slip rate below which the approach to rest is not resolved (m/s).
  Lanes armed_ = 0.0, swing_ = 1.0, rest_floor_ = 0.0;
  Lanes amplitude_ = 0.0, slip_rate_max_{}, slip_rate_min_{}, friction_max_{}, friction_min_{};
  Lanes flagged_ = 0.0;  ///< 1 where the last step may hold an event, else 0
  Lanes counted_ = 0.0, loop_{}, friction_sum_{}, slip_rate_sum_{};
  long attempts_ = 0;  ///< attempts of the ensemble so far
};

}  // namespace rosin::analysis::lanes
