/// Passages of many sliders from section to section at once, in SIMD lanes: the return map without its derivative.
#pragma once
#include <array>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "oscillators/slider_lanes.hpp"
#include "solvers/lanes/ensemble.hpp"

namespace rosin::analysis::lanes {

/// What a passage measures on its way; what is not asked for costs nothing.
struct Recording {
  bool stick_fraction = false, slow_fraction = false, stick_fraction_001 = false, stick_fraction_05 = false;
  bool loop_area = false;
  bool extremes = false;  ///< of slip rate and friction
  bool means = false;     ///< of slip rate and friction
  double stick_threshold = 0.1;
};

/// One motion to follow, from y to the next passage through the section, and what came of it. The section is v = V with
/// v rising; under a set-valued law it is the onset of slip, where the drive has loaded a contact at rest to its limit.
struct LanePassage {
  const oscillators::SliderSystem* slider = nullptr;
  std::array<double, solvers::lanes::Ensemble::capacity> y{};  ///< unknowns: start, then end, on the section
  double tolerance = 1e-6;
  double first_step = 0;          ///< s
  double growth_time = infinity;  ///< of steady sliding, s: near it no step may be longer
  double longest = infinity;      ///< s, before the passage is given up
  bool from_section = true;       ///< y lies on the section; else, under a set-valued law, at rest
  double dip = 1e-10;             ///< part of V that v must fall below V before a rise counts
  bool record = false;
  std::size_t label = 0;  ///< for the queue to know it by

  Ending ending = Ending::budget_spent;
  double duration = 0, amplitude = 0;  ///< s; largest |v − V|/V
  double last_step = 0;                ///< s, to go on with
  long tries = 0;                      ///< of steps
  cycles::Metrics metrics;             ///< what was recorded
  bool touches_threshold = false;      ///< ringing turns at a stick threshold: time within it is ill-conditioned
};

/// Supplies passages and takes them back.
class PassageQueue {
 public:
  virtual ~PassageQueue() = default;
  /// The next passage to follow, or nullptr if there is none at present.
  virtual LanePassage* next() = 0;
  virtual void finished(LanePassage&) = 0;
};

/// Follows passages of sliders with mass, 32 at a time; a lane that has finished one takes the next. All of its
/// passages record, or none does, because lanes do their work together.
class PassageLanes {
 public:
  static constexpr long most_tries = 20'000;  ///< of steps in one passage

  /// True if lanes can follow this slider: it has mass and a constant drive; a set-valued law needs load, speed and
  /// spring too.
  static bool serves(const oscillators::SliderSystem&);
  /// `pattern`: any of the sliders; all must fit it (SliderLanes::fits).
  PassageLanes(const oscillators::SliderSystem& pattern, const Recording&);
  /// Works until the queue is empty and all lanes are idle.
  void run(PassageQueue&);
  bool fits(const oscillators::SliderSystem& slider) const { return sliders_.fits(slider); }

 private:
  enum class Landing : std::int8_t { none, section, level, slip_rate_extreme, friction_extreme, stop, release };
  struct Event {
    Landing kind = Landing::none;
    int level = 0;
    double theta = 2;
  };
  static constexpr int most_levels = 3;
  struct Level {
    double factor;  ///< threshold over V
    double cycles::Metrics::*member;
  };
  struct Lane {
    LanePassage* passage = nullptr;
    const oscillators::SliderSystem* loaded = nullptr;
    double V = 0;
    Event landing;  ///< what the next step is to end on
    double entered[most_levels] = {};
    long begun = 0;  ///< attempts before this passage
    // Of set-valued laws: time before the present mode, time in stick so far.
    double elapsed = 0, stuck = 0;
    bool grazes = false;  ///< whether slip sticks cannot be told here
  };

  bool take(int lane, PassageQueue&);
  /// What to do with the step just taken: the event to retake it for, if any.
  Event look_for_events(int lane);
  enum class Arrival { go_on, retaken, finished, switched, given_up };
  /// What the last step of a flagged lane has led to.
  Arrival follow(int lane);
  /// Handles the event that the last step was to end on.
  Arrival arrive(int lane);
  /// The end of stick or slip in the last step, if there is one.
  Event look_for_level(int lane);
  Event look_for_switch(int lane);
  void cross(int lane, int level, double moment);
  /// Moves the end of the last step to `theta` of it, with the integrals.
  void end_step_at(int lane, double theta);
  /// Begins what follows a mode that has just ended. Finished at the section.
  Arrival change_mode(int lane);
  void begin_mode(int lane, double direction, const double* y);
  void bound_switching_steps();
  /// Flags the lanes whose last step needs a closer look, all at once.
  void screen();
  void see();
  void end(int lane, PassageQueue&);
  void measure_steps();
  void accumulate();
  void accumulate_at_nodes();
  double section_value(int lane, double theta) const;
  void interpolate(int lane, double theta, double* y) const;
  /// Unknowns of all lanes at each `theta` of the last step.
  template <std::size_t n>
  void interpolate(const double (&theta)[n], std::array<Lanes, solvers::lanes::Ensemble::capacity> (&y)[n]) const;
  double friction_at(int lane, double theta) const;
  /// What is left until a contact that sticks gives way (newton).
  double holding_margin(int lane, double theta) const;
  /// Time since the passage began.
  double now(int lane) const { return lanes_[lane].elapsed + ensemble_.time(lane); }
  template <class Question>
  static Arrival answered(Question);
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
  // Of idle lanes too, which compute along: what they hold is of no meaning, but a number.
  Lanes landed_{};  ///< slip rate that a step may always take away where slip comes down to a reversal; 0: any step
  Lanes section_{}, creep_{};                         ///< contact slip rate, and at the end of the last step taken
  Lanes slip_rate_slope_[2]{}, friction_slope_[2]{};  ///< at both ends of the step, by θ
  Lanes friction_[2]{};                               ///< at both ends of the step
  Lanes V_ = 1.0, floor_ = 0.0, growth_time_ = infinity, longest_ = infinity, thresholds_[most_levels]{};
  Lanes felt_ = 1.0;  ///< slip rate from which growth out of stick is followed
  // 1 or 0: has been below V; follows a passage; is to land on an event; records; lies within a stick threshold.
  Lanes below_ = 0.0, active_ = 0.0, landing_ = 0.0, records_ = 0.0, inside_[most_levels]{};
  // Of set-valued laws: 1 or 0, slip has left the neighbourhood of rest that it began in; a part of the free swing (s);
  // slip rates below which the approach to rest does not matter (m/s).
  Lanes armed_ = 0.0, swing_ = 1.0, landing_floor_ = 0.0;
  Lanes amplitude_ = 0.0, slip_rate_max_{}, slip_rate_min_{}, friction_max_{}, friction_min_{};
  Lanes flagged_ = 0.0;  ///< needs a closer look
  Lanes counted_ = 0.0, loop_{}, friction_sum_{}, slip_rate_sum_{};
  long attempts_ = 0;  ///< of the ensemble so far
};

}  // namespace rosin::analysis::lanes
