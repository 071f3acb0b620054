/// What the benches of one cycle and of a plane share: the truth of a point, rosin's and the rivals' ways to it.
#pragma once
#include <functional>

#include "bench/rivals.hpp"
#include "bench/rows.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"

namespace bench {

/// The slider of Woodhouse, Putelat & McKay (2015), Figs 1 and 2, at load N (newton) and λ.
rosin::oscillators::Model bristol_board(double N, double lambda);
inline constexpr double weight = 9.81;  ///< newton, of the 1 kg slider

/// A point of the plane with what is known to be true there.
struct Truth {
  double N, lambda;
  Reading value;
  double loop_size;  ///< slip_rate_max · friction_max
  Reading error;     ///< claimed by the reference
  Start section;     ///< a point of the cycle
  Problem problem() const {
    Problem p;
    p.N = N, p.lambda = lambda;
    return p;
  }
};
/// By rosin at the given tolerance.
Truth truth_of(double N, double lambda, double tolerance);
/// CVODE from the same point of the section, in other variables and by other code, at three tolerances: how far it lies
/// from the truth, and how far from itself. Nothing if CVODE fails (`why` says how).
struct Check {
  Errors between, noise;
};
bool check(const Truth&, double tightest, Check&, std::string& why);

inline const std::vector<std::string> cycle_quantities = {"period", "stick_fraction", "loop_area"};
Errors errors_of(const Reading&, const Truth&);
/// Enters a reading into a row.
void take(Row&, const Reading&, const Truth&);

struct Solver {
  std::string name;
  std::function<Reading(const Truth&, double tolerance)> solve;
};
/// rosin's ways to a cycle, and the rivals', each as a user writes it and with an accelerated return map.
std::vector<Solver> rosin_solvers();
std::vector<Solver> rivals();
std::vector<Row> sweep(const Solver&, const std::vector<Truth>&, const std::vector<double>& tolerances,
                       const Settings&);
std::vector<Row> sweep_scipy(const SciPy&, const std::string& method, const std::vector<Truth>&,
                             const std::vector<double>& tolerances, int repetitions);

}  // namespace bench
