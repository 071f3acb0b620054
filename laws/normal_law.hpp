/// Normal laws: how a contact answers motion along its normal, and what load its friction is a part of.
///
/// A contact is approached by a at the rate ȧ. It bears p, and friction is μ times its bound: p itself, or what p is at
/// ȧ = 0, or a power of a. Both are forces of a contact with one station, and pressures of one with an area.
#pragma once
#include <memory>

#include "core/parameters.hpp"
#include "laws/law.hpp"

namespace rosin {

/// p and the load that friction is a part of, with their slopes by approach and rate.
struct NormalAnswer {
  double pressure = 0, pressure_by_approach = 0, pressure_by_rate = 0;
  double bound = 0, bound_by_approach = 0, bound_by_rate = 0;
};

/// A normal law with its parameter values: immutable and shared.
class NormalLaw {
 public:
  virtual ~NormalLaw() = default;
  virtual const Card& card() const = 0;
  /// \param preload  what presses the contact where nothing moves
  virtual NormalAnswer at(double approach, double rate, double preload) const = 0;
  /// The approach at which the contact bears its preload, at rest.
  virtual double approach_under(double preload) const = 0;
  /// Energy stored at rest, from the approach of 0 on (J, or J/m² of a pressure).
  virtual double elastic_energy(double approach) const = 0;
  /// Whether the answer is smooth on either side of its kink, up to it.
  virtual bool is_smooth_beside_kink() const { return true; }
  /// Changes sign where the answer has a kink; NaN: nowhere. Approach and rate are in sizes of their own.
  virtual double kink(double approach, double rate, double approach_size, double rate_size, double preload) const = 0;
};

namespace laws {

/// p = p₀ + k a + k₃ a³ + d ȧ about the preload p₀, cut off at 0 where the contact can lift off. Friction is a part of
/// p.
struct LinearContact {
  static constexpr Card card{.name = "linear",
                             .title = "Linear normal contact about a preload",
                             .formula = R"(p = \max(0,\; p_0 + k a + k_3 a^3 + d \dot a))",
                             .source = "Hoffmann, Fischer, Allgaier & Gaul (2002)",
                             .limits = "the stiffness does not fall with the load; before lift-off it jumps to 0"};
  double stiffness = 0, cubic = 0, damping = 0;
  bool lift_off = true;  ///< the contact only presses
  static constexpr auto parameters = table(
      field(&LinearContact::stiffness, "stiffness", "N/m", {0, 1e15}, "stiffness of the contact along its normal"),
      field(&LinearContact::cubic, "cubic", "N/m^3", {0, 1e30}, "cubic stiffness of the contact along its normal"),
      field(&LinearContact::damping, "damping", "N s/m", {0, 1e15}, "damping of the contact along its normal"));
};
std::shared_ptr<const NormalLaw> normal_law(const LinearContact&);

/// Power-law compliance of rough surfaces: p = c a₊ᵐ + b a₊ˡ ȧ, with another b while they separate. Units follow from
/// the exponents: c in N/mᵐ, b in N s/m^(l+1), each over m² of a contact with an area.
struct PowerContact {
  static constexpr Card card{.name = "power",
                             .title = "Power-law normal compliance",
                             .formula = R"(p = c\,a_+^m + b\,a_+^l\,\dot a,\quad
b = b_+ \text{ at } \dot a > 0,\; b_- \text{ at } \dot a \le 0)",
                             .source = "Oden & Martins (1985); damping as of Hunt & Crossley (1975)",
                             .limits = "small approaches of elastic asperities; no hysteresis beside the damping"};
  double coefficient = 1;                            ///< c
  double exponent = 1;                               ///< m
  double damping = 0, separation_damping = 0;        ///< b₊, b₋
  double damping_exponent = 1;                       ///< l
  bool adhesion = false;                             ///< p may fall below 0 while the surfaces separate fast
  bool bound_of_pressure = false;                    ///< friction is a part of p, damping included
  double bound_coefficient = 1, bound_exponent = 1;  ///< else of this times a₊ to the exponent
  static constexpr Range exponents{1, 10}, damping_exponents{0, 10};
};
/// \throws InputError for values out of range.
std::shared_ptr<const NormalLaw> normal_law(const PowerContact&);

}  // namespace laws
}  // namespace rosin
