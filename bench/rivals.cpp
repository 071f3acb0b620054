/// CVODE and Boost.odeint behind one loop of passages; periods, stick and loop area from their dense output.
#include "bench/rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <stdexcept>
#include <sundials/sundials_context.hpp>

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

template <class Form>
class CvodeStepper {
 public:
  CvodeStepper(const Problem& p, double tolerance, const Start& start) : p_(p) {
    y_ = N_VNew_Serial(3, context_);
    dense_ = N_VNew_Serial(3, context_);
    const Vector y0 = Form::start(p, start.x, start.v, start.psi), scale = Form::scale(p);
    std::copy(y0.begin(), y0.end(), N_VGetArrayPointer(y_));
    for (int i = 0; i < 3; ++i) N_VGetArrayPointer(dense_)[i] = tolerance * scale[i];
    memory_ = CVodeCreate(CV_BDF, context_);
    CVodeSetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);
    CVodeInit(memory_, rate, 0, y_);
    CVodeSetUserData(memory_, this);
    CVodeSVtolerances(memory_, tolerance, dense_);
    matrix_ = SUNDenseMatrix(3, 3, context_);
    linear_ = SUNLinSol_Dense(y_, matrix_, context_);
    CVodeSetLinearSolver(memory_, linear_, matrix_);
    CVodeSetJacFn(memory_, jacobian);
    CVodeSetMaxNumSteps(memory_, 100'000'000);  // the default of 500 ends most passages
    CVodeSetMaxErrTestFails(memory_, 100);
    CVodeSetMaxConvFails(memory_, 100);
    CVodeRootInit(memory_, 1, section);
    int rising = 1;
    CVodeSetRootDirection(memory_, &rising);
    CVodeSetNoInactiveRootWarn(memory_);
    CVodeSetMaxStep(memory_, p.longest_passage());
  }
  CvodeStepper(const CvodeStepper&) = delete;
  ~CvodeStepper() {
    CVodeFree(&memory_);
    SUNLinSolFree(linear_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    N_VDestroy(dense_);
  }
  void step() {
    // With CV_ONE_STEP the output time matters for the first step only, whose length is guessed from it.
    constexpr double first_output = 1;
    before_ = t_;
    const int flag = CVode(memory_, first_output, y_, &t_, CV_ONE_STEP);
    if (flag < 0) throw std::runtime_error(flag_name(flag));
    at_section_ = flag == CV_ROOT_RETURN;
  }
  double time() const { return t_; }
  double time_before() const { return before_; }
  bool at_section() const { return at_section_; }
  std::pair<double, double> point() const { return Form::section_point(vector(y_)); }
  double slip_rate() const { return Form::slip_rate(p_, vector(y_)); }
  Seen at(double t) const {
    CVodeGetDky(memory_, t, 0, dense_);
    const Vector y = vector(dense_);
    CVodeGetDky(memory_, t, 1, dense_);
    return Form::seen(p_, y, vector(dense_));
  }

 private:
  static Vector vector(N_Vector v) {
    const double* d = N_VGetArrayPointer(v);
    return {d[0], d[1], d[2]};
  }
  static std::string flag_name(int flag) {
    char* name = CVodeGetReturnFlagName(flag);
    std::string text = name;
    free(name);
    return text;
  }
  static int rate(realtype, N_Vector y, N_Vector f, void* data) {
    Vector r;
    Form::rate(static_cast<CvodeStepper*>(data)->p_, vector(y), r);
    std::copy(r.begin(), r.end(), N_VGetArrayPointer(f));
    return std::isfinite(r[0] + r[1] + r[2]) ? 0 : 1;  // 1: try a shorter step
  }
  static int jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
    Matrix j;
    Form::jacobian(static_cast<CvodeStepper*>(data)->p_, vector(y), j);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) SM_ELEMENT_D(J, r, c) = j[r][c];
    return 0;
  }
  static int section(realtype, N_Vector y, realtype* value, void* data) {
    const Problem& p = static_cast<CvodeStepper*>(data)->p_;
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

template <class Stepper>
Reading guarded(const Problem& p, double tolerance, double agree, const Start& start, int passages = 0) {
  Reading reading;
  try {
    Stepper stepper(p, tolerance, start);
    reading = settle(stepper, p, agree, passages);
  } catch (const std::exception& e) {
    reading.failure = e.what();
  }
  return reading;
}

}  // namespace

template <class Form>
Reading run_cvode(const Problem& p, double tolerance, const Start& start, int passages) {
  // Return maps of BDF are noisy at about ten times its tolerance: a stricter test would never be met.
  return guarded<CvodeStepper<Form>>(p, tolerance, 10 * tolerance, start, passages);
}
template <class Form>
Reading run_rosenbrock(const Problem& p, double tolerance, const Start& start) {
  return guarded<RosenbrockStepper<Form>>(p, tolerance, tolerance, start);
}
template Reading run_cvode<Natural>(const Problem&, double, const Start&, int);
template Reading run_cvode<Good>(const Problem&, double, const Start&, int);
template Reading run_rosenbrock<Natural>(const Problem&, double, const Start&);
template Reading run_rosenbrock<Good>(const Problem&, double, const Start&);

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
