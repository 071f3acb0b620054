/// A structure with friction contacts: M q̈ + C q̇ + K q = f(t) + Σ (t F − n (N − N₀)), any number of coordinates and
/// contacts. N₀ is the load that presses a contact, and N what it bears.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "laws/normal_law.hpp"
#include "oscillators/gauss_points.hpp"
#include "oscillators/model.hpp"

namespace rosin::oscillators {

/// A contact of a structure with a surface that moves. Friction F on the structure acts along t where the surface is
/// the faster.
struct FrictionContact {
  std::shared_ptr<const FrictionLaw> law;
  double lambda = 1;  ///< clock factor of the law's states
  ContactStiffness stiffness;
  double load_memory = 0;
  Eigen::VectorXd tangential;  ///< t: the slip rate is speed − tᵀ q̇; 0: the contact has no friction
  Signal speed = 1.0;          ///< of the surface, m/s
  Signal normal_load = 1.0;    ///< N
  double load_factor = 1;      ///< times normal_load: the load of this contact, or its preload
  /// n: motion along it presses, by the approach a = nᵀ q − gap; empty: the load is prescribed. A column for each
  /// station of a contact with an area, which slides as one.
  Eigen::MatrixXd normal;
  Eigen::VectorXd area, gap;  ///< of the stations, m² and m; empty: pressures are forces (1), and 0
  std::shared_ptr<const NormalLaw> normal_law;
  /// A rigid face, whose approach is linear along it: its stations are points of the part that touches, wherever the
  /// structure stands. The columns of `normal` are those of a face that touches throughout.
  struct Face {
    double half_length = 0, thickness = 0;  ///< m
    Eigen::VectorXd middle, along;  ///< the normal at a place x on −half_length … half_length: middle + x·along
    std::vector<GaussPoint> points;
  };
  std::optional<Face> face = {};
  /// A ring around a point: the directions n and t are those of the ring where it is touched along n, and turn with the
  /// point. With x = nᵀ q − c₁ and y = tᵀ q − c₂ the approach is √(x² + y²) − gap, along (x n + y t)/√(x² + y²).
  struct Ring {
    double centre[2] = {0, 0};  ///< c₁ and c₂, m
  };
  std::optional<Ring> ring = {};
  /// Direction in which the load N₀ acts on the structure; empty: along n, of a contact of one station.
  Eigen::VectorXd load_along;

  bool frictionless() const { return tangential.isZero(0); }
};

/// An end stop of a coordinate q, on the side +1 where q cannot go up and −1 where it cannot go down. A rigid one turns
/// the velocity v into −restitution·v at once. One that gives way pushes back with stiffness·a + damping·ȧ where it is
/// penetrated by a > 0, and never pulls.
struct Stop {
  int coordinate = 0;      ///< from 0
  double at = 0;           ///< m
  int side = 1;            ///< +1 or −1
  double restitution = 0;  ///< of a rigid stop, 0 … 1
  double stiffness = 0;    ///< N/m; 0: rigid
  double damping = 0;      ///< N s/m
  bool rigid() const { return stiffness == 0; }
};

/// A force u = command − stiffness·x − damping·ẋ + the integral on coordinate x whose source gives no more than a
/// limit, as a motor does. Matrices and forces of the structure hold u; beyond the limit what is too much of it is
/// taken off.
struct LimitedForce {
  int coordinate = 0;                 ///< from 0
  double stiffness = 0, damping = 0;  ///< N/m, N s/m
  Signal command = 0.0;               ///< N
  int integral = -1;                  ///< coordinate without mass (N) that is a part of u; −1: none
  double limit = 1;                   ///< N
  double tracking = 0;                ///< 1/s: the integral loses this times what is too much; 0: it goes on
};

/// A position servo, u = kp (r − x) + ki ∫(r − x) dt − kd ẋ + c ṙ on coordinate x (N), no more than its limit. Where u
/// is beyond the limit the integral goes on, or, with an anti-windup time T, follows what the limit leaves of u: f
/// being the integral's part, ḟ = ki (r − x) − (u − limited u)/T (back-calculation, Åström & Hägglund 1995,
/// section 3.5).
struct Servo {
  int coordinate = 0;                                     ///< from 0
  double proportional = 0, integral = 0, derivative = 0;  ///< N/m, N/(m s), N s/m
  double feedforward = 0;                                 ///< c, N s/m
  Signal reference = 0.0;                                 ///< m
  double limit = infinity;                                ///< N
  double anti_windup = infinity;                          ///< s; infinity: the integral goes on
  double sampling_time = 0;                               ///< s; 0: it acts without delay
  double encoder_resolution = 0;                          ///< m: position is read as a multiple of it; 0: exactly
  double filter = 0;                                      ///< s, of the speed by differences of readings
  /// Speed is the difference of readings over the sampling time, and not measured itself.
  bool reads_differences() const { return encoder_resolution > 0 || filter > 0; }
};

/// A servo whose program runs once each sampling time h, at t = 0, h, 2h, …, and whose force is held in between. With
/// readings x_k of position and v_k of speed
///   u_k = kp (r_k − x_k) + f_k − kd v_k + c ṙ_k, limited,   f_{k+1} = f_k + h (ki (r_k − x_k) − (u − limited u)_k/T)
///   v_k = (T_f v_{k−1} + x_k − x_{k−1})/(T_f + h) by differences, T_f the filter time
/// (Åström & Hägglund 1995, section 3.6). What it remembers are coordinates without mass, which move at samples alone.
struct SampledServo {
  Servo servo;
  int held = 0;  ///< coordinate of the force; behind it those of f, x_{k−1}, v_{k−1}, as far as they are needed

  int integral() const { return servo.integral > 0 ? held + 1 : -1; }
  int reading() const { return servo.reads_differences() ? held + 1 + (servo.integral > 0) : -1; }
  int speed() const { return servo.reads_differences() ? reading() + 1 : -1; }
  double read(double x) const;  ///< as the encoder has it
  bool is_sample(double t) const;
  double next_sample(double t) const;
};

/// A number that is seen of the coordinates: row·q.
struct Functional {
  std::string name, unit;
  Eigen::VectorXd row;
};

/// Coordinates q (m) from the place where springs are relaxed.
struct Structure {
  Eigen::MatrixXd M, C, K;         ///< kg, N s/m, N/m; n × n
  std::vector<Signal> force;       ///< N on each coordinate; empty: none
  std::vector<std::string> names;  ///< of the coordinates, for columns and messages
  std::vector<std::string> units;  ///< of the coordinates; empty: m
  std::vector<FrictionContact> contacts;
  std::vector<Stop> stops;
  std::vector<LimitedForce> limited;
  std::vector<SampledServo> sampled;
  std::vector<Functional> functionals;  ///< that stand for the coordinates where these are many

  int size() const { return int(M.rows()); }
  std::string unit(int coordinate) const { return units.empty() ? "m" : units[coordinate]; }
  bool constant() const;  ///< nothing that drives it varies, and nothing samples it
  /// \throws InputError for sizes that do not fit, an M that is not symmetric and positive definite, contacts that
  /// stick along directions that depend on each other, parts of a contact that do not go together, and rigid stops
  /// where an impact would be shared by masses.
  void check() const;
  /// Friction may hold the coordinate on a surface at rest.
  bool stands_still(int coordinate) const;
  /// Its matrices can feed energy, as those of a controller do: K is not symmetric, or C does not damp every motion.
  bool feeds_itself() const;
  /// \throws InputError where no surface moves, nothing varies, and it does not feed itself: all motion dies out.
  void require_drive() const;

 private:
  void check_stops() const;
};

/// A slider's contact, along the first coordinate of a structure of one.
FrictionContact contact_of(const Model&);
/// A contact that only presses, along n.
FrictionContact frictionless_contact(Eigen::VectorXd normal, std::shared_ptr<const NormalLaw>);
/// A slider as a structure of one coordinate. \throws InputError for an infinite stiffness, which imposes the motion.
Structure one_slider(const Model&);

/// A structure that has no steady sliding, or none that was found. Others of its family may have.
class NoSteadySliding : public InputError {
 public:
  using InputError::InputError;
};

/// The period of all drives: that of constant ones is 0. \throws InputError where they have none in common, or break,
/// or where a servo samples at other moments in each.
double common_period(const Structure&);

/// Block on a belt (mass, spring, damper) before a second mass that is held by a spring and a damper of its own:
/// m ẍ = −k (x − y) − c (ẋ − ẏ) + F + f, m₂ ÿ = k (x − y) + c (ẋ − ẏ) − k₂ y − c₂ ẏ.
struct TwoMassBelt {
  Slider block, second;
};
Structure two_mass_belt(const TwoMassBelt&, const FrictionContact&, const Signal& force);

/// A block on springs at angles to the direction of sliding, pressed on a belt by a contact that gives way (Hoffmann,
/// Fischer, Allgaier & Gaul 2002): coordinates along the belt and into it, coupled by K and by friction.
struct ModeCoupling {
  struct Spring {
    double stiffness, angle;  ///< N/m; rad, from the direction of sliding
  };
  double mass[2] = {1, 1};     ///< kg, along and into the belt
  double damping[2] = {0, 0};  ///< N s/m
  std::vector<Spring> springs;
  std::shared_ptr<const NormalLaw> contact;
};
Structure mode_coupling(const ModeCoupling&, const FrictionContact&, const Signal& force);

/// Blocks in a row: `coupling` between neighbours, `pull` from each to the fixed frame; masses of their own.
/// \param contacts  one for each block; their directions are set here
struct Chain {
  std::vector<double> mass, coupling_stiffness, coupling_damping, pull_stiffness, pull_damping;
};
/// \throws InputError for lists that do not fit: n masses, n − 1 couplings, n pulls.
Structure chain(const Chain&, std::vector<FrictionContact> contacts);

}  // namespace rosin::oscillators
