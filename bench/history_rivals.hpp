/// General-purpose integrators applied to a history: from a start to an end, nothing else.
#pragma once
#include <array>
#include <string>

#include "bench/fault_problem.hpp"
#include "bench/slider_problem.hpp"

namespace bench {

/// A state at the end, or why there is none.
template <class Form>
struct Arrival {
  std::array<double, Form::size> y{};
  long steps = 0;
  std::string failure = {};
};

template <class Form>
using State = std::array<double, Form::size>;

/// CVODE: BDF, dense exact Jacobian. ARKODE: its default diagonally implicit method of order 4. Absolute tolerances are
/// the relative one times the form's scale.
template <class Form>
Arrival<Form> follow_cvode(const typename Form::Setting&, const State<Form>& start, double duration, double tolerance);
template <class Form>
Arrival<Form> follow_arkode(const typename Form::Setting&, const State<Form>& start, double duration, double tolerance);
/// Boost.odeint: rosenbrock4 and dopri5 under their own step control, in units of the form's scale.
template <class Form>
Arrival<Form> follow_rosenbrock(const typename Form::Setting&, const State<Form>& start, double duration,
                                double tolerance);
template <class Form>
Arrival<Form> follow_dopri5(const typename Form::Setting&, const State<Form>& start, double duration, double tolerance);

/// ln v at the end of the fault's history by an explicit method of order 8 in extended precision.
double fault_reference(const Fault&, double tolerance);
/// The largest deviation of the fault's analytic Jacobians from differences, a check of this bench's own.
double fault_jacobian_defect();

}  // namespace bench
