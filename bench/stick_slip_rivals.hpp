/// Stick–slip of a mass under a harmonic force and a harmonic load, followed by CVODE from event to event.
#pragma once
#include <array>
#include <string>

namespace bench {

/// m ẍ + c ẋ + k x = P cos(we t) + F; |F| ≤ μs N at rest, −μk N sgn(ẋ) in motion, N = Nc + Nv cos(wn t). From x0 at
/// rest.
struct StickSlip {
  double m, k, c, mus, muk, x0, Nc, Nv, P, wn, we;
};

constexpr int sample_count = 8;
constexpr double sample_interval = 0.25;  // s

struct Displacements {
  std::array<double, sample_count> x{};
  std::string failure = {};
};

/// CVODE with root finding: the velocity in slip, what is left of the holding force in stick; `adams`: the methods for
/// what is not stiff, else BDF. As its user would write it for this problem.
Displacements follow_cvode_events(const StickSlip&, bool adams, double tolerance);

}  // namespace bench
