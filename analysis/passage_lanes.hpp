/// Passages of many sliders from section to section at once, in SIMD lanes: the return map without its derivative.
#pragma once
#include <array>
#include <vector>

#include "analysis/cycle.hpp"
#include "oscillators/slider_lanes.hpp"
#include "solvers/ensemble.hpp"

namespace rosin::analysis {

/// What a passage measures on its way; what is not asked for costs nothing.
struct Recording {
  bool stick_fraction = false, stick_fraction_001 = false, stick_fraction_05 = false;
  bool loop_area = false;
  bool extremes = false;  ///< of slip rate and friction
  bool means = false;     ///< of slip rate and friction
  double stick_threshold = 0.1;
};

/// One motion to follow, from y to the next passage through v = V with v rising, and what came of it.
struct LanePassage {
  const oscillators::SliderSystem* slider = nullptr;
  std::array<double, solvers::Ensemble::capacity> y{};  ///< unknowns: start, then end, on the section
  double tolerance = 1e-6;
  double first_step = 0;          ///< s
  double growth_time = infinity;  ///< of steady sliding, s: near it no step may be longer
  double longest = infinity;      ///< s, before the passage is given up
  bool from_section = true;       ///< y lies on the section
  double dip = 1e-10;             ///< part of V that v must fall below V before a rise counts
  bool record = false;
  std::size_t label = 0;  ///< for the queue to know it by

  Ending ending = Ending::budget_spent;
  double duration = 0, amplitude = 0;  ///< s; largest |v − V|/V
  double last_step = 0;                ///< s, to go on with
  long tries = 0;                      ///< of steps
  Metrics metrics;                     ///< what was recorded
};

/// Supplies passages and takes them back.
class PassageQueue {
 public:
  virtual ~PassageQueue() = default;
  /// The next passage to follow, or nullptr if there is none at present.
  virtual LanePassage* next() = 0;
  virtual void finished(LanePassage&) = 0;
};

/// Follows passages of sliders with mass, 32 at a time; a lane that has finished one takes the next.
class PassageLanes {
 public:
  static constexpr long most_tries = 20'000;  ///< of steps in one passage

  /// True if lanes can follow this slider: it has mass, a smooth law, a constant drive and not too many unknowns.
  static bool serves(const oscillators::SliderSystem&);
  /// `pattern`: any of the sliders; all must fit it (SliderLanes::fits).
  PassageLanes(const oscillators::SliderSystem& pattern, const Recording&);
  /// Works until the queue is empty and all lanes are idle.
  void run(PassageQueue&);
  bool fits(const oscillators::SliderSystem& slider) const { return sliders_.fits(slider); }

 private:
  enum class Landing : std::int8_t { none, section, level, slip_rate_extreme, friction_extreme };
  struct Event {
    Landing kind = Landing::none;
    int level = 0;
    double theta = 2;
  };
  static constexpr int most_levels = 3;
  struct Level {
    double factor;  ///< threshold over V
    double Metrics::*member;
  };
  struct Lane {
    LanePassage* passage = nullptr;
    const oscillators::SliderSystem* loaded = nullptr;
    double V = 0;
    Event landing;  ///< what the next step is to end on
    double entered[most_levels] = {};
    long begun = 0;  ///< attempts before this passage
  };

  bool take(int lane, PassageQueue&);
  /// What to do with the step just taken: the event to retake it for, if any.
  Event look_for_events(int lane);
  enum class Arrival { go_on, retaken, finished };
  /// Handles the event that the last step was to end on.
  Arrival arrive(int lane);
  void cross(int lane, int level, double moment);
  /// Flags the lanes whose last step needs a closer look, all at once.
  void screen();
  void see();
  void end(int lane, PassageQueue&);
  void measure_steps();
  void accumulate();
  double section_value(int lane, double theta) const;
  template <class F>
  static double bisect(F f, double low, double high);

  oscillators::SliderLanes sliders_;
  solvers::Ensemble ensemble_;
  Recording recording_;
  std::vector<Level> levels_;
  int friction_index_;
  bool rigid_;
  bool rings_;  ///< the slip rate may swing several times across a threshold
  std::array<Lane, lane_count> lanes_;
  Lanes section_;                                 ///< contact slip rate
  Lanes slip_rate_slope_[2], friction_slope_[2];  ///< at both ends of the step, by θ
  Lanes V_ = 1.0, floor_ = 0.0, growth_time_ = infinity, longest_ = infinity, thresholds_[most_levels];
  // 1 or 0: has been below V; follows a passage; is to land on an event; records; lies within a stick threshold.
  Lanes below_ = 0.0, active_ = 0.0, landing_ = 0.0, records_ = 0.0, inside_[most_levels];
  Lanes amplitude_ = 0.0, slip_rate_max_, slip_rate_min_, friction_max_, friction_min_;
  Lanes flagged_ = 0.0;  ///< needs a closer look
  Lanes counted_ = 0.0, loop_, friction_sum_, slip_rate_sum_;
  long attempts_ = 0;  ///< of the ensemble so far
};

}  // namespace rosin::analysis
