/// CVODE, ARKODE and Boost.odeint from a start to an end.
#include "bench/history_rivals.hpp"

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <stdexcept>
#include <sundials/sundials_context.hpp>

#include "bench/sundials_packages.hpp"

namespace bench {
namespace {

constexpr long most_steps = 2'000'000;

template <class Form>
using Square = std::array<State<Form>, Form::size>;

template <class Form>
bool finite(const State<Form>& y) {
  double sum = 0;
  for (const double x : y) sum += x;
  return std::isfinite(sum);
}

template <class Form>
State<Form> read(N_Vector v) {
  State<Form> y;
  std::copy_n(N_VGetArrayPointer(v), Form::size, y.begin());
  return y;
}

template <class Package, class Form>
Arrival<Form> follow_sundials(const typename Form::Setting& p, const State<Form>& start, double duration,
                              double tolerance) {
  constexpr int n = Form::size;
  Arrival<Form> arrival;
  sundials::Context context;
  N_Vector y = N_VNew_Serial(n, context), absolute = N_VNew_Serial(n, context);
  const auto scale = Form::scale(p);
  std::copy(start.begin(), start.end(), N_VGetArrayPointer(y));
  for (int i = 0; i < n; ++i) N_VGetArrayPointer(absolute)[i] = tolerance * scale[i];
  const auto rate = [](realtype, N_Vector at, N_Vector f, void* data) {
    State<Form> r;
    Form::rate(*static_cast<const typename Form::Setting*>(data), read<Form>(at), r);
    std::copy(r.begin(), r.end(), N_VGetArrayPointer(f));
    return finite<Form>(r) ? 0 : 1;  // 1: try a shorter step
  };
  const auto jacobian = [](realtype, N_Vector at, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
    Square<Form> j;
    Form::jacobian(*static_cast<const typename Form::Setting*>(data), read<Form>(at), j);
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c) SM_ELEMENT_D(J, r, c) = j[r][c];
    return 0;
  };
  void* memory = Package::create(rate, y, context);
  Package::set_errors(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  Package::set_data(memory, const_cast<typename Form::Setting*>(&p));
  Package::set_tolerances(memory, tolerance, absolute);
  SUNMatrix matrix = SUNDenseMatrix(n, n, context);
  SUNLinearSolver linear = SUNLinSol_Dense(y, matrix, context);
  Package::set_linear_solver(memory, linear, matrix);
  Package::set_jacobian(memory, jacobian);
  Package::set_most_steps(memory, most_steps);
  Package::set_most_error_failures(memory, 100);
  Package::set_most_newton_failures(memory, 100);
  Package::set_stop_time(memory, duration);
  double t = 0;
  const int flag = Package::advance(memory, duration, y, &t, CV_NORMAL);
  if (flag < 0) {
    char* name = Package::flag_name(flag);
    arrival.failure = name;
    free(name);
  }
  Package::steps(memory, &arrival.steps);
  arrival.y = read<Form>(y);
  Package::free(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  N_VDestroy(absolute);
  return arrival;
}

/// odeint goes on for ever where stability holds its steps; an observer ends that.
struct Budget {
  long* steps;
  template <class State>
  void operator()(const State&, double) const {
    if (++*steps > most_steps) throw std::runtime_error("more than 2e6 steps");
  }
};

template <class Form>
Arrival<Form> checked(Arrival<Form> arrival) {
  if (arrival.failure.empty() && !finite<Form>(arrival.y)) arrival.failure = "not finite";
  return arrival;
}

}  // namespace

template <class Form>
Arrival<Form> follow_cvode(const typename Form::Setting& p, const State<Form>& start, double duration,
                           double tolerance) {
  return checked(follow_sundials<Cvode, Form>(p, start, duration, tolerance));
}
template <class Form>
Arrival<Form> follow_arkode(const typename Form::Setting& p, const State<Form>& start, double duration,
                            double tolerance) {
  return checked(follow_sundials<Arkode, Form>(p, start, duration, tolerance));
}

template <class Form>
Arrival<Form> follow_rosenbrock(const typename Form::Setting& p, const State<Form>& start, double duration,
                                double tolerance) {
  using namespace boost::numeric;
  constexpr int n = Form::size;
  const auto scale = Form::scale(p);
  const auto physical = [&](const ublas::vector<double>& z) {
    State<Form> y;
    for (int i = 0; i < n; ++i) y[i] = z[i] * scale[i];
    return y;
  };
  const auto rate = [&](const ublas::vector<double>& z, ublas::vector<double>& f, double) {
    State<Form> r;
    Form::rate(p, physical(z), r);
    for (int i = 0; i < n; ++i) f[i] = r[i] / scale[i];
  };
  const auto jacobian = [&](const ublas::vector<double>& z, ublas::matrix<double>& J, double,
                            ublas::vector<double>& in_time) {
    Square<Form> j;
    Form::jacobian(p, physical(z), j);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c < n; ++c) J(r, c) = j[r][c] * scale[c] / scale[r];
      in_time[r] = 0;
    }
  };
  Arrival<Form> arrival;
  ublas::vector<double> z(n);
  for (int i = 0; i < n; ++i) z[i] = start[i] / scale[i];
  try {
    odeint::integrate_adaptive(odeint::rosenbrock4_controller<odeint::rosenbrock4<double>>(tolerance, tolerance),
                               std::make_pair(rate, jacobian), z, 0.0, duration, 1e-6, Budget{&arrival.steps});
  } catch (const std::exception& e) {
    arrival.failure = e.what();
  }
  arrival.y = physical(z);
  return checked(arrival);
}

template <class Form>
Arrival<Form> follow_dopri5(const typename Form::Setting& p, const State<Form>& start, double duration,
                            double tolerance) {
  using namespace boost::numeric::odeint;
  Arrival<Form> arrival;
  arrival.y = start;
  const auto rate = [&](const State<Form>& y, State<Form>& f, double) { Form::rate(p, y, f); };
  try {
    integrate_adaptive(make_controlled<runge_kutta_dopri5<State<Form>>>(tolerance, tolerance), rate, arrival.y, 0.0,
                       duration, 1e-6, Budget{&arrival.steps});
  } catch (const std::exception& e) {
    arrival.failure = e.what();
  }
  return checked(arrival);
}

#define BENCH_FORM(Form, Setting)                                                                 \
  template Arrival<Form> follow_cvode<Form>(const Setting&, const State<Form>&, double, double);  \
  template Arrival<Form> follow_arkode<Form>(const Setting&, const State<Form>&, double, double); \
  template Arrival<Form> follow_rosenbrock<Form>(const Setting&, const State<Form>&, double, double);
BENCH_FORM(LogarithmicFault, Fault)
BENCH_FORM(NaturalFault, Fault)
BENCH_FORM(Natural, Problem)
BENCH_FORM(Good, Problem)
#undef BENCH_FORM
template Arrival<LogarithmicFault> follow_dopri5<LogarithmicFault>(const Fault&, const State<LogarithmicFault>&, double,
                                                                   double);
template Arrival<Good> follow_dopri5<Good>(const Problem&, const State<Good>&, double, double);

double fault_reference(const Fault& p, double tolerance) {
  using namespace boost::numeric::odeint;
  using Real = long double;
  using Long = std::array<Real, 2>;
  Long y = LogarithmicFault::start<Real>(p);
  const auto rate = [&](const Long& at, Long& f, Real) { LogarithmicFault::rate(p, at, f); };
  integrate_adaptive(make_controlled<runge_kutta_fehlberg78<Long, Real, Long, Real>>(Real(tolerance), Real(tolerance)),
                     rate, y, Real(0), Real(p.duration), Real(1e-6));
  return double(y[0]);
}

namespace {
template <class Form>
double defect_of(const Fault& p, const State<Form>& y) {
  Square<Form> J;
  Form::jacobian(p, y, J);
  double largest = 0;
  for (int c = 0; c < Form::size; ++c) {
    State<Form> f[4];
    const double at[4] = {-2, -1, 1, 2}, d = 1e-4 * std::abs(y[c]);
    for (int i = 0; i < 4; ++i) {
      State<Form> z = y;
      z[c] += at[i] * d;
      Form::rate(p, z, f[i]);
    }
    for (int r = 0; r < Form::size; ++r) {
      const double difference = (8 * (f[2][r] - f[1][r]) - (f[3][r] - f[0][r])) / (12 * d);
      largest = std::max(largest, std::abs(difference - J[r][c]) / (std::abs(J[r][c]) + 1e-12 * std::abs(f[1][r]) / d));
    }
  }
  return largest;
}
}  // namespace
double fault_jacobian_defect() {
  const Fault p;
  double largest = 0;
  for (const double v : {1e-10, 1e-6, 0.1})
    for (const double theta : {1e-3, 10.0})
      largest = std::max({largest, defect_of<NaturalFault>(p, {v, theta}),
                          defect_of<LogarithmicFault>(p, {std::log(v), std::log(theta)})});
  return largest;
}

}  // namespace bench
