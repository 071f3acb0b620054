/// CVODE, ARKODE and Boost.odeint behind one loop of passages; periods, stick and loop area from their dense output.
#include "bench/rivals.hpp"

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

/// Where f changes sign between a and b, to rounding.
template <class F>
double bisect(F f, double a, double b) {
  const bool sign = f(a) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (a + b);
    if (middle == a || middle == b) break;
    ((f(middle) > 0) == sign ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

/// Adds up stick time and loop area over steps with dense output.
class Measure {
 public:
  explicit Measure(const Problem& p) : p_(p) {}
  /// `at(t)` → Seen.
  template <class At>
  void interval(double t0, double t1, At at) {
    static constexpr double node[4] = {0.069431844202973712, 0.33000947820757187, 0.66999052179242813,
                                       0.93056815579702629};
    static constexpr double weight[2] = {0.17392742256872693, 0.32607257743127307};
    const double h = t1 - t0, limit = 0.1 * p_.V;
    if (!(h > 0)) return;
    double before = t0, v_before = at(t0).v;
    const auto advance = [&](double t, double v) {
      double crossing[2] = {t, t};
      int n = 0;
      for (const double level : {limit, -limit})
        if ((v_before > level) != (v > level))
          crossing[n++] = bisect([&](double s) { return at(s).v - level; }, before, t);
      if (n == 2 && crossing[1] < crossing[0]) std::swap(crossing[0], crossing[1]);
      bool inside = std::abs(v_before) <= limit;
      double from = before;
      for (int i = 0; i < n; ++i) {
        if (inside) stick_ += crossing[i] - from;
        from = crossing[i];
        inside = n == 1 ? !inside : i == 0;  // two crossings between samples: in between them it is inside
      }
      if (inside) stick_ += t - from;
      before = t, v_before = v;
    };
    for (int i = 0; i < 4; ++i) {
      const double t = t0 + node[i] * h;
      const Seen s = at(t);
      loop_ += h * weight[i == 0 || i == 3 ? 0 : 1] * (s.mu - p_.steady_friction(s.v)) * s.v_rate;
      advance(t, s.v);
    }
    advance(t1, at(t1).v);
  }
  double stick() const { return stick_; }
  double loop() const { return std::abs(loop_); }

 private:
  const Problem& p_;
  double stick_ = 0, loop_ = 0;
};

/// Passages until successive ones agree to `agree`, then one more that is measured. A stepper has step(): one step, or
/// the part of it up to the section; time(), time_before(), at_section(), slip_rate(), point(), at(t) → Seen.
template <class Stepper>
Reading settle(Stepper& stepper, const Problem& p, double agree, int passages) {
  Reading reading;
  Measure measure(p);
  double began = 0, amplitude = 0;
  Passage last{};
  bool measuring = false;
  for (long steps = 0; steps < 50'000; ++steps) {  // in one passage
    stepper.step();
    const double t = stepper.time();
    if (measuring) measure.interval(stepper.time_before(), t, [&](double s) { return stepper.at(s); });
    amplitude = std::max(amplitude, std::abs(stepper.slip_rate() / p.V - 1));
    if (stepper.at_section()) {
      const double period = t - began;
      ++reading.passages;
      if (measuring) {
        reading.period = period;
        reading.stick_fraction = measure.stick() / period;
        reading.loop_area = measure.loop();
        return reading;
      }
      const auto [x, psi] = stepper.point();
      const Passage now{period, x, psi};
      // The first passage starts anywhere: it is no period, and short if the start lies on the section.
      if (reading.passages > 1 && amplitude < died_out) {
        reading.steady = true;
        return reading;
      }
      measuring = passages > 0 ? reading.passages == passages : reading.passages > 2 && agrees(p, now, last, agree);
      if (!measuring && reading.passages >= most_passages) {
        reading.failure = "not settled in 200 passages";
        return reading;
      }
      last = now, began = t, amplitude = 0, steps = 0;
    } else if (t - began > p.longest_passage()) {
      reading.steady = amplitude < died_out || std::abs(stepper.slip_rate() / p.V - 1) < died_out;
      if (!reading.steady) reading.failure = "no passage through v = V";
      return reading;
    }
  }
  reading.failure = "5e4 steps in one passage";
  return reading;
}

template <class Package, class Form>
class SundialsStepper {
 public:
  SundialsStepper(const Problem& p, double tolerance, const Start& start) : p_(p) {
    y_ = N_VNew_Serial(3, context_);
    dense_ = N_VNew_Serial(3, context_);
    const Vector y0 = Form::start(p, start.x, start.v, start.psi), scale = Form::scale(p);
    std::copy(y0.begin(), y0.end(), N_VGetArrayPointer(y_));
    for (int i = 0; i < 3; ++i) N_VGetArrayPointer(dense_)[i] = tolerance * scale[i];
    memory_ = Package::create(rate, y_, context_);
    Package::set_errors(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);
    Package::set_data(memory_, this);
    Package::set_tolerances(memory_, tolerance, dense_);
    matrix_ = SUNDenseMatrix(3, 3, context_);
    linear_ = SUNLinSol_Dense(y_, matrix_, context_);
    Package::set_linear_solver(memory_, linear_, matrix_);
    Package::set_jacobian(memory_, jacobian);
    Package::set_most_steps(memory_, 100'000'000);  // the default of 500 ends most passages
    Package::set_most_error_failures(memory_, 100);
    Package::set_most_newton_failures(memory_, 100);
    Package::set_root(memory_, 1, section);
    int rising = 1;
    Package::set_root_direction(memory_, &rising);
    Package::no_root_warning(memory_);
    Package::set_longest_step(memory_, p.longest_passage());
  }
  SundialsStepper(const SundialsStepper&) = delete;
  ~SundialsStepper() {
    Package::free(&memory_);
    SUNLinSolFree(linear_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    N_VDestroy(dense_);
  }
  void step() {
    // With CV_ONE_STEP the output time matters for the first step only, whose length is guessed from it.
    constexpr double first_output = 1;
    before_ = t_;
    const int flag = Package::advance(memory_, first_output, y_, &t_, CV_ONE_STEP);
    if (flag < 0) throw std::runtime_error(flag_name(flag));
    at_section_ = flag == CV_ROOT_RETURN;
  }
  double time() const { return t_; }
  double time_before() const { return before_; }
  bool at_section() const { return at_section_; }
  std::pair<double, double> point() const { return Form::section_point(vector(y_)); }
  double slip_rate() const { return Form::slip_rate(p_, vector(y_)); }
  Seen at(double t) const {
    Package::derivative(memory_, t, 0, dense_);
    const Vector y = vector(dense_);
    Package::derivative(memory_, t, 1, dense_);
    return Form::seen(p_, y, vector(dense_));
  }

 private:
  static Vector vector(N_Vector v) {
    const double* d = N_VGetArrayPointer(v);
    return {d[0], d[1], d[2]};
  }
  static std::string flag_name(int flag) {
    char* name = Package::flag_name(flag);
    std::string text = name;
    free(name);
    return text;
  }
  static int rate(realtype, N_Vector y, N_Vector f, void* data) {
    Vector r;
    Form::rate(static_cast<SundialsStepper*>(data)->p_, vector(y), r);
    std::copy(r.begin(), r.end(), N_VGetArrayPointer(f));
    return std::isfinite(r[0] + r[1] + r[2]) ? 0 : 1;  // 1: try a shorter step
  }
  static int jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
    Matrix j;
    Form::jacobian(static_cast<SundialsStepper*>(data)->p_, vector(y), j);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) SM_ELEMENT_D(J, r, c) = j[r][c];
    return 0;
  }
  static int section(realtype, N_Vector y, realtype* value, void* data) {
    const Problem& p = static_cast<SundialsStepper*>(data)->p_;
    value[0] = Form::slip_rate(p, vector(y)) / p.V - 1;
    return 0;
  }

  const Problem& p_;
  sundials::Context context_;
  N_Vector y_ = nullptr, dense_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
  void* memory_ = nullptr;
  double t_ = 0, before_ = 0;
  bool at_section_ = false;
};

/// odeint takes one absolute tolerance for all variables, so that they are integrated in units of their scale.
template <class Form>
class RosenbrockStepper {
  using State = boost::numeric::ublas::vector<double>;
  using Square = boost::numeric::ublas::matrix<double>;
  using Base = boost::numeric::odeint::rosenbrock4<double>;
  using Controller = boost::numeric::odeint::rosenbrock4_controller<Base>;

 public:
  RosenbrockStepper(const Problem& p, double tolerance, const Start& start)
      : p_(p), scale_(Form::scale(p)), stepper_(Controller(tolerance, tolerance, p.longest_passage())), work_(3) {
    const Vector y = Form::start(p, start.x, start.v, start.psi);
    for (int i = 0; i < 3; ++i) work_[i] = y[i] / scale_[i];
    stepper_.initialize(work_, 0.0, 1e-6);
  }
  void step() {
    if (at_section_) {  // the rest of the step in which the section lies
      before_ = t_, t_ = step_end_, at_section_ = false;
      return;
    }
    const double v_before = slip_rate();
    const auto rate = [this](const State& z, State& f, double) {
      Vector r;
      Form::rate(p_, physical(z), r);
      for (int i = 0; i < 3; ++i) f[i] = r[i] / scale_[i];
    };
    const auto jacobian = [this](const State& z, Square& J, double, State& in_time) {
      Matrix j;
      Form::jacobian(p_, physical(z), j);
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) J(r, c) = j[r][c] * scale_[c] / scale_[r];
        in_time[r] = 0;
      }
    };
    std::tie(before_, t_) = stepper_.do_step(std::make_pair(rate, jacobian));
    step_end_ = t_;
    const double v = slip_rate();
    if (!std::isfinite(v)) throw std::runtime_error("not finite");
    if (v_before < p_.V && v >= p_.V) {
      t_ = bisect([this](double s) { return Form::slip_rate(p_, dense(s)) - p_.V; }, before_, t_);
      at_section_ = true;
    }
  }
  double time() const { return t_; }
  double time_before() const { return before_; }
  bool at_section() const { return at_section_; }
  std::pair<double, double> point() { return Form::section_point(dense(t_)); }
  double slip_rate() const { return Form::slip_rate(p_, physical(stepper_.current_state())); }
  Seen at(double t) {
    const Vector y = dense(t);
    // The dense output is a cubic, for which this difference is exact.
    const double d = 0.125 * (step_end_ - stepper_.previous_time());
    const Vector a = dense(t - 2 * d), b = dense(t - d), c = dense(t + d), e = dense(t + 2 * d);
    Vector rate;
    for (int i = 0; i < 3; ++i) rate[i] = (8 * (c[i] - b[i]) - (e[i] - a[i])) / (12 * d);
    return Form::seen(p_, y, rate);
  }

 private:
  Vector physical(const State& z) const { return {z[0] * scale_[0], z[1] * scale_[1], z[2] * scale_[2]}; }
  Vector dense(double t) {
    stepper_.calc_state(t, work_);
    return physical(work_);
  }

  const Problem& p_;
  Vector scale_;
  boost::numeric::odeint::rosenbrock4_dense_output<Controller> stepper_;
  State work_;
  double t_ = 0, before_ = 0, step_end_ = 0;
  bool at_section_ = false;
};

/// One passage from a point of the section, or from anywhere, to the next point of the section.
struct Return {
  double period = 0, x = 0, psi = 0, amplitude = 0;
  std::string failure = {};
};
template <class Stepper>
Return follow_once(const Problem& p, double tolerance, const Start& from, Measure* measure) {
  Stepper stepper(p, tolerance, from);
  Return r;
  // A start on the section may cross it once more by rounding.
  const double soon = 0.1 * 2 * M_PI * std::sqrt(p.m / p.k);
  for (long steps = 0; steps < 50'000; ++steps) {
    stepper.step();
    const double t = stepper.time();
    if (measure) measure->interval(stepper.time_before(), t, [&](double s) { return stepper.at(s); });
    r.amplitude = std::max(r.amplitude, std::abs(stepper.slip_rate() / p.V - 1));
    if (stepper.at_section() && t > soon) {
      r.period = t;
      std::tie(r.x, r.psi) = stepper.point();
      return r;
    }
    if (t > p.longest_passage()) {
      r.failure = "no passage through v = V";
      return r;
    }
  }
  r.failure = "5e4 steps in one passage";
  return r;
}

/// The fixed point of the return map by Anderson mixing of depth 2. Points are in units in which a change of one
/// matters alike. A mixed point that leaves its neighbourhood, fails, or does not bring the residual down is dropped.
template <class Stepper>
Reading accelerate(const Problem& p, double tolerance, double agree, const Start& start) {
  using Point = std::array<double, 2>;
  const double x_unit = p.N * p.a / p.k;
  const auto start_at = [&](const Point& z) { return Start{z[0] * x_unit, p.V, std::exp(z[1])}; };
  const auto difference = [](const Point& a, const Point& b) { return Point{a[0] - b[0], a[1] - b[1]}; };
  const auto size = [](const Point& a) { return std::hypot(a[0], a[1]); };
  struct Visit {
    Point image, residual;
  };
  Reading reading;
  Return last = follow_once<Stepper>(p, tolerance, start, nullptr);
  ++reading.passages;
  if (!last.failure.empty()) {
    reading.steady = last.amplitude < died_out;
    reading.failure = reading.steady ? "" : last.failure;
    return reading;
  }
  Point z = {last.x / x_unit, std::log(last.psi)}, image = z;
  std::array<Visit, 3> visits;
  int known = 0;
  bool mixed = false;
  double least_residual = INFINITY, amplitude = last.amplitude;
  while (true) {
    if (reading.passages >= most_passages) {
      reading.failure = "not settled in 200 passages";
      return reading;
    }
    const Start from = start_at(z);
    if (mixed && !(p.k * from.x > p.N * p.friction(p.V, from.psi))) {
      z = image, mixed = false, known = 0;
      continue;
    }
    Return now = follow_once<Stepper>(p, tolerance, from, nullptr);
    ++reading.passages;
    const bool failed = !now.failure.empty() || !(now.psi > 0);
    if (failed && !mixed) {
      reading.steady = now.amplitude < died_out;
      reading.failure = reading.steady ? "" : now.failure;
      return reading;
    }
    const Point arrived = {now.x / x_unit, std::log(now.psi)}, residual = difference(arrived, z);
    if (mixed && (failed || now.amplitude < 0.5 * amplitude || !(size(residual) < least_residual))) {
      z = image, mixed = false, known = 0;
      continue;
    }
    if (now.amplitude < died_out) {
      reading.steady = true;
      return reading;
    }
    const bool settled = agrees(p, {now.period, now.x, now.psi}, {last.period, from.x, from.psi}, agree);
    last = now, amplitude = now.amplitude;
    least_residual = size(residual);
    image = arrived;
    if (settled && reading.passages > 2) break;
    std::rotate(visits.rbegin(), visits.rbegin() + 1, visits.rend());
    visits[0] = {arrived, residual};
    known = std::min(known + 1, 3);
    // z = g₀ − Σ γ_i (g₀ − g_i), γ least squares of r₀ − Σ γ_i (r₀ − r_i).
    z = arrived, mixed = false;
    if (known < 2) continue;
    const Point d1 = difference(visits[0].residual, visits[1].residual);
    const Point e1 = difference(visits[0].image, visits[1].image);
    Point step{};
    bool found = false;
    if (known == 3) {
      const Point d2 = difference(visits[0].residual, visits[2].residual);
      const Point e2 = difference(visits[0].image, visits[2].image);
      const double determinant = d1[0] * d2[1] - d1[1] * d2[0];
      if (std::abs(determinant) > 1e-3 * size(d1) * size(d2)) {
        const double g1 = (residual[0] * d2[1] - residual[1] * d2[0]) / determinant,
                     g2 = (d1[0] * residual[1] - d1[1] * residual[0]) / determinant;
        step = {g1 * e1[0] + g2 * e2[0], g1 * e1[1] + g2 * e2[1]};
        found = true;
      }
    }
    if (!found) {
      const double g = (residual[0] * d1[0] + residual[1] * d1[1]) / (size(d1) * size(d1));
      step = {g * e1[0], g * e1[1]};
    }
    if (!(size(step) < 3 * size(residual))) continue;
    z = difference(arrived, step);
    mixed = true;
  }
  Measure measure(p);
  const Return cycle = follow_once<Stepper>(p, tolerance, start_at(image), &measure);
  ++reading.passages;
  reading.failure = cycle.failure;
  reading.period = cycle.period;
  reading.stick_fraction = measure.stick() / cycle.period;
  reading.loop_area = measure.loop();
  return reading;
}

template <class Stepper>
Reading guarded(const Problem& p, double tolerance, double agree, const Start& start, Search search, int passages = 0) {
  Reading reading;
  try {
    if (search == Search::accelerate) return accelerate<Stepper>(p, tolerance, agree, start);
    Stepper stepper(p, tolerance, start);
    reading = settle(stepper, p, agree, passages);
  } catch (const std::exception& e) {
    reading.failure = e.what();
  }
  return reading;
}

}  // namespace

template <class Form>
Reading run_cvode(const Problem& p, double tolerance, const Start& start, Search search, int passages) {
  // Return maps of BDF are noisy at about ten times its tolerance: a stricter test would never be met.
  return guarded<SundialsStepper<Cvode, Form>>(p, tolerance, 10 * tolerance, start, search, passages);
}
template <class Form>
Reading run_arkode(const Problem& p, double tolerance, const Start& start, Search search) {
  return guarded<SundialsStepper<Arkode, Form>>(p, tolerance, tolerance, start, search);
}
template <class Form>
Reading run_rosenbrock(const Problem& p, double tolerance, const Start& start, Search search) {
  return guarded<RosenbrockStepper<Form>>(p, tolerance, tolerance, start, search);
}
template Reading run_cvode<Natural>(const Problem&, double, const Start&, Search, int);
template Reading run_cvode<Good>(const Problem&, double, const Start&, Search, int);
template Reading run_arkode<Good>(const Problem&, double, const Start&, Search);
template Reading run_rosenbrock<Natural>(const Problem&, double, const Start&, Search);
template Reading run_rosenbrock<Good>(const Problem&, double, const Start&, Search);

namespace {
template <class Form>
double defect_of() {
  double largest = 0;
  const Problem p;
  for (const double v : {3e-8, 1e-5, 8e-5, -2e-7})
    for (const double psi : {2e-5, 3e-3, 0.2}) {
      const Vector y = Form::start(p, 3.5e-4, v, psi), scale = Form::scale(p);
      Matrix J;
      Form::jacobian(p, y, J);
      for (int c = 0; c < 3; ++c) {
        const double d = 1e-4 * (Form::name[3] == 'v' ? std::min(scale[c], std::abs(y[c])) : scale[c]);
        Vector f[4];
        const double at[4] = {-2, -1, 1, 2};
        for (int i = 0; i < 4; ++i) {
          Vector z = y;
          z[c] += at[i] * d;
          Form::rate(p, z, f[i]);
        }
        for (int r = 0; r < 3; ++r) {
          const double difference = (8 * (f[2][r] - f[1][r]) - (f[3][r] - f[0][r])) / (12 * d);
          const double noise = 1e-14 * (std::abs(f[1][r]) + (r == 1 ? std::abs(p.N * p.k) : 0)) / d;
          largest = std::max(largest, (std::abs(difference - J[r][c]) - noise) / (std::abs(J[r][c]) + 1e-300));
        }
      }
    }
  return largest;
}
}  // namespace
double jacobian_defect() { return std::max(defect_of<Natural>(), defect_of<Good>()); }

}  // namespace bench
