/// Blocks on belts under a periodic force, 32 at once, from one moment of the force's period to the next.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/contact.hpp"
#include "core/switching.hpp"
#include "oscillators/structure.hpp"
#include "solvers/lanes/dormand_prince_tableau.hpp"

namespace rosin::analysis::lanes {

/// One coordinate on a surface of constant speed, under constant load: m ẍ = −k x − c ẋ + F(V − ẋ) + f(t).
struct DrivenBlock {
  double mass, stiffness, damping, speed, load;  ///< kg, N/m, N s/m, m/s, N
  std::shared_ptr<const FrictionLaw> law;        ///< set-valued, without states, lists or kinks
  Signal::Piece force;                           ///< N
  double period;                                 ///< s, of the force

  /// Nothing for a structure that is no such block.
  static std::optional<DrivenBlock> of(const oscillators::Structure&);
};

/// A motion to follow from t = 0, and what it comes to.
struct DrivenMotion {
  DrivenBlock block;
  double displacement = 0, slip_rate = 0;  ///< m; m/s along the surface: at the start, then at the end
  double tolerance = 1e-8;                 ///< relative, of a step
  int transient = 0, keep = 1;             ///< periods of the force that are not recorded, and that are

  struct Moment {
    double displacement, slip_rate;
    ContactMode contact;
  };
  std::vector<Moment> moments = {};  ///< at the end of each period that is recorded
  struct Growth {
    double logarithm;      ///< of what a disturbance has grown by in a period of the force
    double along, across;  ///< its displacement and slip rate at the end, in sizes of the motion: a unit vector
  };
  std::vector<Growth> growth = {};  ///< in each period that is recorded, if asked
  std::string why = {};             ///< the motion could not be followed to its end; else empty
};

/// Follows motions 32 at a time; a lane that has finished one takes the next. Slip by an explicit method of order 8,
/// whose steps end at moments of the force and where slip ends; stick in closed form, from moment to moment no release
/// is passed over. What one lane does is independent of its neighbours, to the last bit.
class DrivenLanes {
 public:
  /// Whether motions of both may be followed at once.
  static bool alike(const DrivenBlock&, const DrivenBlock&);
  /// \param pattern  any of the blocks; all must be alike
  /// \param disturb  carries a disturbance along each motion, exact through the ends of slip and stick
  explicit DrivenLanes(const DrivenBlock& pattern, bool disturb = false);
  /// \throws Stopped if the thread was asked to stop.
  void run(std::span<DrivenMotion>);

 private:
  using Method = solvers::lanes::DormandPrince8;
  struct Lane {
    DrivenMotion* motion = nullptr;   ///< nullptr: idle
    bool fresh = false;               ///< has not begun
    double limit = 0, kinetic = 0;    ///< N, of the friction that holds
    double bend = 0;                  ///< N/s², bound of f″
    double size = 1, speed_size = 1;  ///< m, m/s: what errors are measured by
    double step = 0;                  ///< s, that accuracy allows
    bool locating = false;            ///< the step is to end where slip ends
    int passed = 0;                   ///< periods of the force
    int stalls = 0;                   ///< slips in a row that ended as they began
    long attempts = 0;
  };

  void attempt();
  template <int stage>
  void begin_stage();
  template <int stage>
  void begin_disturbed_stage();
  void decide();
  void decide_disturbed();
  /// What the last try means for a lane.
  void follow(int lane);
  void end_slip(int lane, double left);
  /// From rest: stick until the force releases the contact, period after period, or slip at once.
  /// \param before  slip acceleration with which the contact came to rest, m/s²
  void settle(int lane, double before);
  void slip(int lane, double direction);
  void plan_step(int lane);
  /// Time until the contact is released, or `most` (s).
  double time_to_release(int lane, double most) const;
  /// The end of a period. \returns whether the motion goes on.
  bool arrive(int lane, ContactMode);
  void take_next(int lane);
  void begin(int lane);
  void give_up(int lane, std::string why);
  double force(int lane, double t) const;
  double force_rate(int lane, double t) const;
  /// Force that holds a contact at rest, positive where it would slip forward without.
  double held(int lane, double t, double x) const;

  std::unique_ptr<Contact<Lanes>> contact_;
  ContactSetup setup_;
  std::vector<std::array<Lanes, 3>> terms_;  ///< amplitude, angular frequency and phase of each
  Lanes mean_ = 0.0, per_mass_ = 1.0, stiffness_ = 0.0, damping_ = 0.0, speed_ = 0.0, load_ = 0.0;
  Lanes direction_ = 1.0, size_ = 1.0, speed_size_ = 1.0, tolerance_ = 1.0;
  Lanes time_ = 0.0, x_ = 0.0, w_ = 0.0, h_ = 1.0;
  Lanes stage_x_{}, force_{}, friction_{};
  std::array<Lanes, Method::stages> slip_rate_{}, acceleration_{};
  Lanes next_x_{}, next_w_{}, error_{}, factor_{};  ///< error over the tolerance; factor of the next step
  bool disturb_;
  Slopes<Lanes> slopes_{};
  Lanes dx_ = 0.0, dw_ = 0.0, stage_dx_{}, next_dx_{}, next_dw_{};  ///< of displacement and slip rate
  std::array<Lanes, Method::stages> disturbed_slip_rate_{}, disturbed_acceleration_{};
  std::array<Lane, lane_count> lanes_;
  std::span<DrivenMotion> waiting_;
  int active_ = 0;
};

}  // namespace rosin::analysis::lanes
