/// The equations of a structure with friction contacts, assembled into a System.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/switching.hpp"
#include "oscillators/contact_rows.hpp"
#include "oscillators/sparse_rows.hpp"
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// What a stop does: nothing, push back by its spring, or hold the coordinate at rest.
enum class StopMode : std::int8_t { open, pushes, holds };

/// Unknowns: the coordinates q; one speed for each coordinate; the contacts' own.
///
/// The speeds are w = (V − tᵀ q̇ of each contact, q̇ᵢ of the other coordinates), so that slip rates are unknowns: near
/// stick they fall by decades, which V − tᵀ q̇ would lose in rounding, and a contact at rest has a slip rate of exactly
/// 0. A contact whose t depends on those before it has no speed of its own; its slip rate follows from q̇.
///
/// A contact that sticks exerts the force that keeps its slip rate 0. Where masses are shared these forces depend on
/// each other, G F = V̇ − Tᵀ M⁻¹ R with G = Tᵀ M⁻¹ T over the contacts that stick and R all other forces. One behind a
/// spring exerts the force of that, whether its own point sticks or slips.
///
/// Whoever follows a structure with stops sets their modes, as those of contacts. A coordinate that a stop holds does
/// not move, whatever its forces are. Where the surface under it rests too, friction shares in that: the stop bears
/// what pushes into it, and friction what would pull away.
///
/// Where each speed belongs to a mass of its own, as in chains and belts, nothing of this is a matrix: an evaluation
/// takes a time that is linear in the entries of K and C, and the Jacobian has a pattern.
class StructureSystem final : public SwitchingSystem {
 public:
  /// \throws InputError by Structure::check().
  explicit StructureSystem(Structure, Unknowns unknowns = Unknowns::friction);

  int size() const override { return size_; }
  void mass(double t, double* m) const override;
  void evaluate(double t, const double* y, double* f) const override;
  void linearise(double t, const double* y, double* f, double* jacobian) const override;
  const Pattern* pattern() const override { return is_diagonal_ ? &pattern_ : nullptr; }
  void linearise_entries(double t, const double* y, double* f, double* entries) const override;
  void scale(const double* y, double* s) const override;
  std::string unknown(int i) const override;
  double next_break(double t) const override;
  void cross_break(double t, double* y) const override;
  bool autonomous() const override { return is_constant_; }
  double resolution() const override;
  void kinks(double t, const double* y, std::vector<double>& values) const override;
  bool kinks_are_singular() const override;

  int contacts() const override { return int(switching_.size()); }
  ContactMode mode(int contact) const override { return at_[switching_[contact]].mode; }
  void set_mode(int contact, ContactMode mode) override;
  /// Every contact slips along its surface, as in steady sliding.
  void slide();
  bool is_elastic(int contact) const override { return at_[switching_[contact]].is_elastic(); }
  int slip_rate_unknown(int contact) const override { return n_ + at_[switching_[contact]].row; }
  double own_slip_rate(int contact, double t, const double* y) const override {
    return contact_slip_rate(switching_[contact], t, y);
  }
  double displacement(int contact, const double* y) const override;
  double reference_speed(int contact) const override { return at_[switching_[contact]].reference_speed; }
  bool contacts_decide_alone() const override { return is_diagonal_; }
  void held(double t, const double* y, Held* held) const override;
  void slip_accelerations(double t, const double* y, double* acceleration) const override;
  void stop(int contact, double* y) const override;
  void release(int contact, double t, double* y) const override;

  int stops() const { return int(structure_.stops.size()); }
  StopMode stop_mode(int stop) const { return stop_mode_[stop]; }
  void set_stop_mode(int stop, StopMode);
  double stop_gap(int stop, const double* y) const;              ///< m, negative behind the stop
  double stop_speed(int stop, double t, const double* y) const;  ///< towards the stop, m/s
  /// What the stop is pressed with: by its spring and damper as if it touched (negative: it would pull), or by all
  /// other forces where it holds, +∞ where friction at rest shares in that (N).
  double stop_push(int stop, double t, const double* y) const;
  /// Of its coordinate towards the stop, in the present modes (m/s²).
  double stop_acceleration(int stop, double t, const double* y) const;
  /// V̇ of the surface whose slip rate is the speed of a coordinate, 0 where that is its own.
  double surface_acceleration(int coordinate, double t) const;
  /// Gives its coordinate another speed towards the stop: contacts slip by that, along `side` where their slip rate is
  /// then 0.
  void set_stop_speed(int stop, double t, double speed, double side, double* y);
  /// Puts its coordinate on the stop, at rest.
  void rest_on_stop(int stop, double t, double* y);
  /// The contact, among those that switch, that holds the stop's coordinate together with it: its surface rests. −1:
  /// none.
  int contact_beside_stop(int stop, double t) const;
  /// Power of stops that push (W).
  double stop_power(double t, const double* y) const;

  /// A limited force as it would be without its limit (N).
  double unlimited(const LimitedForce&, double t, const double* y) const;
  /// What servos that sample do at a time: at a sample they read the motion and set their forces.
  void sample(double t, double* y) const;
  /// The same at the start of a motion, before which readings were what they are there.
  void begin_sampling(double* y) const;

  /// Power of what limits take off their forces (W).
  double limit_power(double t, const double* y) const;

  const Structure& structure() const { return structure_; }
  int coordinates() const { return n_; }
  int friction_contacts() const { return int(at_.size()); }
  /// Velocities q̇ (m/s), from the speeds of y.
  Eigen::VectorXd velocity(double t, const double* y) const;
  /// Accelerations q̈ (m/s²) by the equation of motion in the present modes, between impacts. Not of a coordinate
  /// without mass.
  Eigen::VectorXd acceleration(double t, const double* y) const;
  double slip_rate(int friction_contact, double t, const double* y) const;
  /// The slip rate of the contact itself, equal to slip_rate() where no spring is in series with it.
  double contact_slip_rate(int friction_contact, double t, const double* y) const;
  /// What t of a contact takes of a vector of the coordinates, tᵀ x; of a ring where it is touched along its n.
  template <class Vector>
  double along(int friction_contact, const Vector& x) const {
    return tangential_[friction_contact].times(x);
  }
  /// tᵀ q̇ where the contact stands (m/s), of velocities that are those of y.
  double speed_along(int friction_contact, const double* y, const Eigen::VectorXd& velocity) const;
  const SparseRows& stiffness() const { return K_; }
  const SparseRows& damping() const { return C_; }
  /// Forces of the contacts on the structure, each along its t (N): friction_contacts() entries.
  void friction_forces(double t, const double* y, double* force) const;
  /// What presses a contact (N), by its preload and by motion along its normal.
  double normal_load(int friction_contact, double t, const double* y) const;
  /// Part of a contact's area, whose load follows motion, that bears nothing.
  double open_fraction(int friction_contact, double t, const double* y) const;
  double reference_speed_of(int friction_contact) const { return at_[friction_contact].reference_speed; }
  bool follows_motion(int friction_contact) const { return structure_.contacts[friction_contact].normal.size() > 0; }
  /// Power of the normal forces that contacts answer motion with, −(N − N₀) nᵀ q̇ (W).
  double normal_power(double t, const double* y) const;
  /// The contact whose modes are counted as `contact`, among all.
  int friction_contact(int contact) const { return switching_[contact]; }
  /// Natural states of a contact's law.
  std::vector<double> states(int friction_contact, double t, const double* y) const;

  /// The unknowns at coordinates q and velocities q̇, with natural states for each contact (empty: those of steady
  /// sliding at the contact's slip rate, or of long rest where that is 0) and relaxed contact springs.
  std::vector<double> unknowns_at(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& velocity,
                                  const std::vector<std::vector<double>>& states = {}) const;
  /// Steady sliding at time t: K q = f + Σ (t F(V, N) − n (N − N₀)), at rest, by Newton's method where loads follow q.
  /// \throws NoSteadySliding where there is none: of a structure that is free to move, or without a solution in reach.
  std::vector<double> steady(double t) const;

 private:
  struct At : ContactRows {  ///< a contact, and where it stands among the unknowns
    using ContactRows::ContactRows;
    int row = -1;   ///< of its speed among the n; −1: it has none of its own
    int first = 0;  ///< of its unknowns
    int first_station = 0, end_station = 0;
    double area = 1;  ///< of all its stations
    double reference_speed = 0, natural_load = 0;
    ContactMode mode = ContactMode::forward;
    /// Slip rate (m/s) below which friction follows from the force that would hold the contact; 0 of most laws.
    double region = 0;
    /// Its stick holds coordinates.
    bool sticks() const { return law->set_valued() && mode == ContactMode::stick && !is_elastic(); }
  };
  struct Load {
    double level, rate;
  };
  Load load(int contact, double t) const;  ///< prescribed, or N₀
  /// What friction is a part of: prescribed, or the bound that follows motion along the normal, whose rate is that of
  /// the approach alone, for contacts behind a spring.
  Load load(int contact, double t, const double* y) const;
  struct Station {  ///< of a contact whose load follows motion
    double area, gap;
    bool preloaded;  ///< N₀ acts along its normal
    SparseRows::Row normal;
  };
  /// Stations of a contact in y: fixed ones, or those of the part of a rigid face that touches.
  class Stations {
   public:
    Stations(const Station* begin, const Station* end) : begin_(begin), end_(end) {}
    Stations(std::vector<Station> own, std::vector<SparseRows::Entry> entries)
        : own_(std::move(own)), entries_(std::move(entries)), begin_(own_.data()), end_(own_.data() + own_.size()) {}
    Stations(const Stations&) = delete;
    Stations(Stations&&) = default;
    const Station* begin() const { return begin_; }
    const Station* end() const { return end_; }

   private:
    std::vector<Station> own_;
    std::vector<SparseRows::Entry> entries_;
    const Station *begin_, *end_;
  };
  Stations stations(int contact, const double* y) const;
  /// How far the directions of a ring are turned from those where it is touched along n.
  struct Turn {
    double cosine, sine;
    double curvature;  ///< 1/m, of the circle on which the point stands
  };
  Turn turn(int contact, const double* y) const;
  /// t and n in y.
  Eigen::VectorXd tangential(int contact, const double* y) const;
  Eigen::VectorXd turned_normal(int contact, const double* y) const;
  NormalAnswer answer(int contact, const Station&, double t, const double* y) const;
  /// What the normal forces of the contact push the structure back with, beyond N₀ (N).
  double push_back(int contact, const Station&, double t, const NormalAnswer&) const;
  /// N₀ as a force of one station, or as its pressure.
  double preload(int contact, double t) const { return load(contact, t).level / at_[contact].area; }
  double natural_load(int contact) const;
  double normal_stiffness(int contact, int coordinate) const;
  double stiffness_at(int coordinate) const;
  double velocity_of(int coordinate, double t, const double* y) const;
  double approach_rate(const Station&, double t, const double* y) const;  ///< nᵀ q̇
  double mobility(int contact) const;                                     ///< tᵀ M⁻¹ t
  double stiffness_along(int contact) const;                              ///< tᵀ K t
  /// What the limit adds to the force: 0 within it (N).
  double cut_off(const LimitedForce&, double t, const double* y) const;
  void find_pattern();
  bool stop_holds(int stop, double t) const;
  struct Balance {
    bool converged, held;  ///< by springs and contacts
    int iterations;
    double left;  ///< N
  };
  Balance balance(double t, double part_of_friction, Eigen::VectorXd& q) const;
  Eigen::VectorXd touching(double t) const;
  double steady_friction(int contact, double t, double N) const;
  double natural_stiffness(const Eigen::VectorXd& along, double force) const;
  const FrictionLaw& law(int contact) const { return *structure_.contacts[contact].law; }
  bool sticks(int contact) const { return at_[contact].sticks(); }
  /// The limit that an elastic contact has in slip is an equation for its deflection.
  bool is_at_limit(const At& at) const { return at.is_elastic() && at.mode != ContactMode::stick && !at.is_damped(); }
  Eigen::VectorXd speeds_of_surfaces(double t) const;
  Eigen::VectorXd accelerations_of_surfaces(double t) const;
  void add_turning(int contact, double t, const double* y, double F, const Slopes<double>& slopes, Eigen::MatrixXd& R_q,
                   Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian) const;
  Eigen::VectorXd forces_without_stick(double t, const double* y, double* contact_rows) const;
  Eigen::VectorXd forces_of_others(double t, const double* y, double* contact_rows) const;
  /// The force that would hold a contact on its own coordinate, where all others exert R.
  double holding(int contact, double t, const Eigen::VectorXd& R) const;
  /// Friction of contacts whose law is smoothed by regions, and the forces that would hold them (N).
  struct InRegions {
    int contact;
    double force, holding, slip;
  };
  std::vector<InRegions> regions(double t, const double* y) const;
  std::vector<InRegions> add_regions(double t, const double* y, Eigen::VectorXd& R, double* contact_rows) const;
  void follow_modes();

  Structure structure_;
  int n_, size_ = 0;
  std::vector<At> at_;
  std::vector<int> switching_;              ///< contacts under set-valued laws
  SparseRows K_, C_, tangential_, normal_;  ///< directions of contacts and of their stations, a row each
  std::vector<Station> station_;
  Eigen::VectorXd along_;            ///< −1 where a speed is a contact's slip rate, else 1
  std::vector<int> contact_of_row_;  ///< −1: none
  Pattern pattern_;
  Eigen::MatrixXd velocity_of_speed_;  ///< ∂q̇/∂w; here and below, nothing where is_diagonal_
  Eigen::MatrixXd inverse_mass_;
  Eigen::VectorXd row_mass_;      ///< of the rows of the speeds
  bool is_diagonal_;              ///< each speed belongs to a mass of its own
  Eigen::MatrixXd acceleration_;  ///< what forces on coordinates add to row_mass·ẇ in the present modes
  /// What surfaces that accelerate add to it through the contacts that stick.
  Eigen::MatrixXd acceleration_of_surfaces_;
  std::vector<int> stuck_;                                        ///< contacts that stick
  Eigen::MatrixXd holding_;                                       ///< forces on them for R, −G⁻¹ Tᵀ M⁻¹
  Eigen::MatrixXd holding_of_surface_;                            ///< and for V̇, G⁻¹
  std::vector<double> holding_alone_, holding_of_surface_alone_;  ///< of each contact where is_diagonal_: −1 and m
  Eigen::VectorXd coordinate_scale_, speed_scale_;
  std::vector<bool> is_held_;  ///< coordinates, by springs or contacts
  bool is_constant_;
  bool has_regions_ = false;
  std::vector<StopMode> stop_mode_;
};

}  // namespace rosin::oscillators
