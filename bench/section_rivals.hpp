/// A block on a belt under a harmonic force as a user writes it down for CVODE: slip between roots, stick by hand.
///
///   x″ = −x − sgn(x′ − V)/(1 + 3|x′ − V|) + cos(2t)/2;  at x′ = V the contact holds up to 1
///   (Awrejcewicz, Grzelczyk & Pyryev 2008, J. Vibroengineering 10 (4))
#pragma once
#include <string>
#include <vector>

namespace bench {

struct ForcedBelt {
  double speed = 0.1, amplitude = 0.5, frequency = 2, delta = 3;
};
struct SectionPoints {
  std::vector<double> x;  ///< at the end of each period of the force
  double growth = 0;      ///< logarithm of what a disturbance of the start has grown by, if asked
  std::string failure;
};
/// From rest on the belt at x = 0. CVODE's Adams methods with roots of the slip rate; stick is followed by the sign of
/// what is left of the holding force, sixty-four times a period, and bisection.
/// \param disturb  carries a disturbance along, through the jumps at the ends of slip and stick
SectionPoints follow_belt_by_cvode(const ForcedBelt&, int periods, double tolerance, bool disturb);

}  // namespace bench
