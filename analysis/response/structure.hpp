/// A vibrating structure with friction contacts: is steady sliding stable, by eigenvalues and by Nyquist, with what
/// margin, from which load on, and how surely.
///
/// M ẍ + C ẋ + K x = Σ t F − n N: contact j slides along t (slip rate V − tᵀẋ) and is pressed by motion along n,
/// δN = (k_n + c_n s) nᵀx on it, −n δN on the structure. Each F, N is that of a FrictionResponse. Any structure is
/// unstable where 1 + s Z(s) H(s), H its receptance, has zeros in the right half-plane: Woodhouse, Putelat & McKay
/// (2015), section 3; Duffour & Woodhouse (2004).
#pragma once
#include <complex>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analysis/response/frf.hpp"
#include "core/uncertain.hpp"
#include "oscillators/structure.hpp"

namespace rosin::analysis::response {

using oscillators::Structure;

/// A mode: its frequency (Hz), damping ratio, modal mass (kg), and amplitudes at the contact.
struct Mode {
  double frequency = 0, damping_ratio = 0, mass = 1, tangential = 1, normal = 0;
};
/// What a mode is given by.
inline constexpr Field<Mode, double> mode_fields[] = {
    field(&Mode::frequency, "frequency", "Hz", {1e-9, 1e9}, "natural frequency"),
    field(&Mode::damping_ratio, "damping_ratio", "1", {0, 10}, "damping over critical"),
    field(&Mode::mass, "mass", "kg", {1e-12, 1e12}, "modal mass"),
    field(&Mode::tangential, "tangential", "1", {-1e15, 1e15}, "amplitude at the contact along slip"),
    field(&Mode::normal, "normal", "1", {-1e15, 1e15}, "amplitude at the contact, pressing")};
/// Modes at one contact as matrices; the contact has its directions alone.
Structure modal(const std::vector<Mode>&);

/// A structure in sliding contact, every contact of which answers as the model does at its load, with the parameters
/// that a path names: those of the model; `structure.modes.2.damping_ratio` of modes, counted from 1;
/// `structure.M`, `.C` and `.K`, factors on matrices; `normal_contact.stiffness`, `.damping` and `.lift`.
struct SlidingStructure {
  /// The slider of the model, modes at one contact, or matrices.
  std::variant<std::monostate, std::vector<Mode>, Structure> form;
  Model model;
  std::optional<NormalContact> normal;

  /// \throws InputError for a slider without mass.
  Structure structure() const;
  /// \throws InputError for a path that names nothing, with what there is.
  Quantity describe(const std::string& path) const;
  double get(const std::string& path) const;
  /// \throws InputError for a value out of range.
  SlidingStructure with(const std::string& path, double value) const;

 private:
  /// A parameter of structure or normal contact, by its path.
  struct Entry {
    Quantity quantity;
    double value;
    std::function<void(SlidingStructure&, double)> set;
  };
  std::vector<Entry> entries() const;
  /// Nothing if the path is one of the model's.
  std::optional<Entry> find(const std::string& path) const;
};

struct ClosedLoop {
  std::vector<std::complex<double>> eigenvalues;  ///< 1/s, largest real part first; those at infinity left out
  bool stable = false;
  /// Neither stable nor unstable: growth is 0 within rounding, as of undamped structures.
  bool marginal = false;
  int unstable_by_eigenvalues = 0;  ///< whose growth is beyond rounding
  /// Turns of the characteristic function as iω runs up the axis (Mikhailov's form of Nyquist's criterion); −1 where
  /// an eigenvalue is so near the axis that the turns cannot be counted.
  int unstable_by_nyquist = 0;
  /// Of a single contact: least |1 + L| over frequency (friction_loop), and where (rad/s). NaN for several contacts.
  double margin = 0, margin_frequency = 0;
};

/// Of the structure's matrices and the directions of its contacts, each of which answers as the model does at its load.
/// `normal`: as FrictionResponse::matrix takes it, stiffness and
/// damping. \throws InputError for matrices that do not fit, a mass matrix without inverse, a contact that is unstable
/// by itself.
ClosedLoop close_loop(const Structure&, const Model&, const std::optional<NormalContact>& normal = {});

/// What presses each contact in steady sliding (N), where the model's load is that without friction: friction moves the
/// structure, K x = Σ t F − n k_n nᵀx, and with it the load. Empty where no contact is pressed by motion, or where the
/// structure has no steady sliding.
std::vector<double> loads_under_friction(const Structure&, const Model&, const NormalContact&);

/// Receptance δ(tᵀx)/δF of the structure at contact 0, m/N.
std::complex<double> receptance(const Structure&, std::complex<double> s);

/// A value at which steady sliding changes stability.
struct CriticalValue {
  double value, angular_frequency, error;
};
/// Along a parameter from low to high on a logarithmic scan, each located to its last digits, where eigenvalues merge
/// too, as those of undamped modes do.
std::vector<CriticalValue> critical_values(const SlidingStructure&, const std::string& parameter, double low,
                                           double high, int points = 60);

/// What one drawing of the inputs gives.
struct Drawn {
  bool unstable;
  double measure;  ///< of stability: the largest real part (1/s), or the margin of tables
};
struct Uncertainty {
  int samples = 0, unstable = 0;
  double probability = 0, standard_error = 0;  ///< that steady sliding is unstable
  double low = 0, median = 0, high = 0;        ///< of the measure: 5, 50 and 95 %
  /// Rank correlation of each parameter with the measure: which of them matters.
  std::vector<double> influence;
};
/// By eigenvalues.
Uncertainty propagate(const SlidingStructure&, const std::vector<Uncertain>&, int samples, std::uint64_t seed);
/// By any judgement of the changed structure; the number of the sample tells what else is drawn for it.
Uncertainty propagate(const SlidingStructure&, const std::vector<Uncertain>&, int samples, std::uint64_t seed,
                      const std::function<Drawn(const SlidingStructure&, int sample)>&);

/// Loop L of friction at these frequencies (Hz): 1 + L = det D/det D₀, D the structure's dynamic stiffness and D₀ that
/// of contacts which press and slide without friction; iω Z H of one contact under a steady load. `friction`: measured
/// Z of every contact, N s/m; empty: the model's. What load does to friction is the model's.
std::vector<std::complex<double>> friction_loop(const Structure&, const Model&, const std::optional<NormalContact>&,
                                                const std::vector<double>& frequency,
                                                const std::vector<std::complex<double>>& friction = {});

/// The loop L at rising frequencies (Hz).
struct LoopPath {
  std::vector<double> frequency;
  std::vector<std::complex<double>> loop;
  std::vector<double> doubt = {};  ///< of each value, by interpolation; empty: none
};
/// The loop of a friction response that was measured at some frequencies and bends little between them, with a
/// structure whose resonances may be narrower than their distance: from the first frequency to the last, as closely as
/// 1 + L turns. Between frequencies Z is a straight line; a quarter of what leaving each of them out would change is
/// the doubt of the values beside it.
LoopPath measured_friction_loop(const Structure&, const Model&, const std::optional<NormalContact>&,
                                const std::vector<double>& frequency,
                                const std::vector<std::complex<double>>& friction);

/// Nyquist on a path of the loop L. Where the phase of 1 + L turns by more than a quarter from one frequency to the
/// next, or doubt is as large as 1 + L, the count is not to be relied on.
struct TableLoop {
  double turns = 0;  ///< of 1 + L about 0 along the table; −1 for each pair of unstable roots between its ends
  int unstable = 0;  ///< roots in the right half-plane, in pairs, if the table's ends enclose them
  bool resolved = true;
  double margin = 0, margin_frequency = 0;  ///< least |1 + L|, and where (Hz)
};
TableLoop close_table(const LoopPath&);

/// Values at which the count of unstable roots changes, of a loop by tables at each value. The error is the range of
/// values for which the table does not resolve the loop.
std::vector<CriticalValue> critical_values(const std::function<TableLoop(double value)>&, double low, double high,
                                           int points = 60);

}  // namespace rosin::analysis::response
