/// The record of one pass over a motion: its columns at the sample times and, whatever these are, their extremes and
/// the slips of its contacts, from the dense output of its steps.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "analysis/motion/run.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::motion {

/// How an error follows from the difference of two passes.
struct ErrorRule {
  double times = 1, least = 0, floor = 0;
  double error(double difference, double size) const { return times * difference + least * size + floor; }
};

/// A contact whose slips are listed.
struct SlipColumns {
  std::size_t slip_rate, displacement;  ///< columns, the displacement along the contact
  double speed;                         ///< m/s, of the surface; 0: none are listed
  double stick_threshold = 0;           ///< over the speed, of a law that creeps; of others switches are located events
  int contact = 0;                      ///< its number, from 1 where there are several
  double stiffness = 0;                 ///< N/m, of the spring whose force falls in a slip; 0: none
  const Signal* load = nullptr;         ///< of the contact, where there is such a spring
};

/// Of a slider whose first columns are displacement, velocity and slip rate: none are listed on a drive whose speed
/// varies, or where the slip rate is imposed.
SlipColumns slip_columns(const Model&, double stick_threshold);

class MotionRecord {
 public:
  /// The row at a time of the present step: `columns`, then columns that are watched and not kept.
  using Row = std::function<void(double t, double* row)>;
  /// The row at (t, y).
  using Observe = std::function<void(double t, const double* y, double* row)>;

  /// \param columns  that are kept; \param watched  beyond these; \param times  outlive this
  MotionRecord(std::size_t columns, std::size_t watched, const std::vector<double>& times,
               std::vector<SlipColumns> contacts = {});

  /// The motion is in one state until t: samples before (or at) it.
  void rest(double t, bool closed, const Row&);
  /// A step from t0 to t1: samples before its end, extremes, slips.
  /// \param inside  times within the step, ascending
  /// \param near  what the step's polynomial shows; \param at  at the full accuracy of the step
  void step(double t0, double t1, std::span<const double> inside, const Row& near, const Row& at);
  void step(double t0, double t1, std::span<const double> inside, const Row& at) { step(t0, t1, inside, at, at); }
  /// The last step of a collocation.
  void step(solvers::steps::Collocation&, const Observe&);
  /// A located switch of a contact at the end of the last step.
  void switched(int contact, bool slips);

  /// Called after the row of each sample.
  std::function<void(double t)> on_sample;

  const std::vector<std::vector<double>>& columns() const { return values_; }
  std::size_t samples() const { return next_; }
  double low(std::size_t column) const { return -extremes_[2 * column].value; }
  double high(std::size_t column) const { return extremes_[2 * column + 1].value; }
  /// The largest absolute value of a column in the motion.
  double size(std::size_t column) const;

 private:
  friend void state_what_is_seen(const MotionRecord&, const MotionRecord*, const std::vector<ErrorRule>&, Run&);
  SlipEvents slip_events() const;

  /// The largest value of ±column.
  struct Extreme {
    std::size_t column;
    double sign, value = -infinity;
  };
  struct Moment {
    double time, displacement;
  };
  struct Slip {
    Moment begin, end;
    double peak;
  };
  struct Watch {
    SlipColumns of;
    bool stuck = false;
    std::optional<Moment> begin;
    Extreme peak;
    std::vector<Slip> slips;
  };
  /// Rows at times of a step, those of its ends at full accuracy.
  struct Nodes {
    std::vector<double> time, rows;
  };

  void sample_until(double t, bool closed, const Row&);
  void include(const double* row);
  double* node(std::size_t i) { return nodes_.rows.data() + i * width_; }
  void raise(Extreme&, const Row& near, const Row& at);
  void follow_slip(Watch&, const Row& near, const Row& at);
  Moment crossing(const Watch&, std::size_t i, const Row& at);
  static void end_slip(Watch&, const Moment&);

  const std::vector<double>& times_;
  std::size_t next_ = 0, width_;
  std::vector<std::vector<double>> values_;  ///< [column][sample]
  std::vector<Extreme> extremes_;            ///< of each column the lowest and the highest
  std::vector<Watch> watches_;
  Nodes nodes_;
  double step_end_ = 0;              ///< s
  std::vector<double> row_, point_;  ///< scratch
};

/// The largest absolute difference of two passes in a column; infinite where the coarse pass ended earlier.
double largest_difference(const std::vector<double>& coarse, const std::vector<double>& fine);
/// Fills in the extremes of the run's columns as metrics and its slip events, with errors from another pass by the
/// rules of the columns; without one they are infinite.
void state_what_is_seen(const MotionRecord&, const MotionRecord* other, const std::vector<ErrorRule>&, Run&);
/// Fills in the errors of the run's events from those of another pass, with caution where a tolerance was `asked`;
/// their size is the mean time between events. And event_time_error, the largest: infinite where passes count other
/// events.
void state_event_errors(Run&, const std::vector<RunEvent>& other, const ErrorRule&, double asked = 0);

}  // namespace rosin::analysis::motion
