/// The SUNDIALS calls behind Cvode.
#include "solvers/steps/cvode.hpp"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "core/stop.hpp"

namespace rosin::solvers::steps {

struct Cvode::Core {
  const System& system;
  double tolerance;
  int roots;
  Roots root_functions;
  sundials::Context context;  // first made, last destroyed
  N_Vector vector = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  void* memory = nullptr;
  bool fresh = true;                            ///< no step has been taken since the start
  double longest = infinity, bound = infinity;  ///< step, of all since the start and of those to come
  double t = 0, last_moment = infinity;  // just before the limit of the step: a jump there must not be seen early
  std::vector<double> y, mass, scale, jacobian, f;
  std::vector<int> found;
  mutable N_Vector inside = nullptr;

  Core(const System& s, double tol, int n_roots, Roots r)
      : system(s), tolerance(tol), roots(n_roots), root_functions(std::move(r)) {
    const int n = system.size();
    y.resize(n), mass.resize(n), scale.resize(n), f.resize(n), jacobian.resize(n * n);
    system.mass(0, mass.data());
    for (int i = 0; i < n; ++i)
      if (mass[i] == 0)
        throw InputError(fmt::format("solver 'cvode' takes no algebraic unknown, but '{}' is one; use 'collocation'",
                                     system.unknown(i)));
    vector = N_VNew_Serial(n, context);
    inside = N_VNew_Serial(n, context);
    matrix = SUNDenseMatrix(n, n, context);
    linear = SUNLinSol_Dense(vector, matrix, context);
  }
  ~Core() {
    if (memory) CVodeFree(&memory);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(inside);
    N_VDestroy(vector);
  }

  static int right_hand_side(realtype t, N_Vector y, N_Vector ydot, void* data) {
    Core& core = *static_cast<Core*>(data);
    double* rate = N_VGetArrayPointer(ydot);
    t = std::min(t, core.last_moment);
    core.system.evaluate(t, N_VGetArrayPointer(y), rate);
    core.system.mass(t, core.mass.data());
    for (int i = 0; i < core.system.size(); ++i) {
      rate[i] /= core.mass[i];
      if (!std::isfinite(rate[i])) return 1;  // recoverable: CVODE tries a shorter step
    }
    return 0;
  }
  static int jacobian_function(realtype t, N_Vector y, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector,
                               N_Vector) {
    Core& core = *static_cast<Core*>(data);
    const int n = core.system.size();
    t = std::min(t, core.last_moment);
    core.system.linearise(t, N_VGetArrayPointer(y), core.f.data(), core.jacobian.data());
    core.system.mass(t, core.mass.data());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) SM_ELEMENT_D(J, i, j) = core.jacobian[i * n + j] / core.mass[i];
    return 0;
  }
  static int weights(N_Vector y, N_Vector w, void* data) {
    Core& core = *static_cast<Core*>(data);
    core.system.scale(N_VGetArrayPointer(y), core.scale.data());
    for (int i = 0; i < core.system.size(); ++i) N_VGetArrayPointer(w)[i] = 1 / (core.tolerance * core.scale[i]);
    return 0;
  }
  static int root_function(realtype t, N_Vector y, realtype* values, void* data) {
    static_cast<Core*>(data)->root_functions(t, N_VGetArrayPointer(y), values);
    return 0;
  }
  static void silent(int, const char*, const char*, char*, void*) {}  // failures come back as outcomes
};

Cvode::Cvode(const System& system, double tolerance, int roots, Roots root_functions)
    : core_(std::make_unique<Core>(system, tolerance, roots, std::move(root_functions))) {}
Cvode::~Cvode() = default;
Cvode::Cvode(Cvode&&) noexcept = default;

void Cvode::start(double t, std::span<const double> y) {
  Core& c = *core_;
  c.t = t;
  c.fresh = true;
  c.y.assign(y.begin(), y.end());
  std::copy(y.begin(), y.end(), N_VGetArrayPointer(c.vector));
  if (c.memory) {
    CVodeReInit(c.memory, t, c.vector);
    return;
  }
  c.memory = CVodeCreate(CV_BDF, c.context);
  CVodeSetErrHandlerFn(c.memory, Core::silent, nullptr);
  CVodeInit(c.memory, Core::right_hand_side, t, c.vector);
  CVodeSetUserData(c.memory, &c);
  CVodeWFtolerances(c.memory, Core::weights);
  CVodeSetLinearSolver(c.memory, c.linear, c.matrix);
  CVodeSetJacFn(c.memory, Core::jacobian_function);
  CVodeSetMaxNumSteps(c.memory, 1'000'000);
  if (c.roots > 0) CVodeRootInit(c.memory, c.roots, Core::root_function);
}

void Cvode::bound_step(double longest) { core_->bound = longest; }

Outcome Cvode::step(double t_limit) {
  end_if_stopped();
  Core& c = *core_;
  CVodeSetStopTime(c.memory, t_limit);
  if (c.fresh) {
    // What is small in its scale would be passed over in a few long steps, the same at every tolerance.
    const double share = 0.3 * std::cbrt(c.tolerance);
    c.longest = std::min(c.system.resolution(), share * (t_limit - c.t));
    c.fresh = false;
  }
  CVodeSetMaxStep(c.memory, std::min(c.longest, c.bound));
  c.last_moment = std::nextafter(t_limit, c.t);
  const int flag = CVode(c.memory, t_limit, c.vector, &c.t, CV_ONE_STEP);
  std::copy_n(N_VGetArrayPointer(c.vector), c.system.size(), c.y.begin());
  c.found.clear();
  if (flag == CV_ROOT_RETURN) {
    c.found.resize(c.roots);
    CVodeGetRootInfo(c.memory, c.found.data());
    return {Ending::event, ""};
  }
  if (flag >= 0) return {};
  const std::unique_ptr<char, decltype(&std::free)> name(CVodeGetReturnFlagName(flag), &std::free);  // ours to free
  const auto where = fmt::format("at t = {:.9g} s, CVODE: {}", c.t, name.get());
  return {flag == CV_RHSFUNC_FAIL || flag == CV_UNREC_RHSFUNC_ERR ? Ending::not_finite : Ending::tolerance_not_met,
          where};
}

double Cvode::time() const { return core_->t; }
const std::vector<double>& Cvode::state() const { return core_->y; }
const std::vector<int>& Cvode::root_found() const { return core_->found; }

void Cvode::interpolate(double t, double* y) const {
  CVodeGetDky(core_->memory, t, 0, core_->inside);
  std::copy_n(N_VGetArrayPointer(core_->inside), core_->system.size(), y);
}

void Cvode::rate(double* rate) const {
  CVodeGetDky(core_->memory, core_->t, 1, core_->inside);
  std::copy_n(N_VGetArrayPointer(core_->inside), core_->system.size(), rate);
}

Cvode::Count Cvode::count() const {
  Count count;
  if (!core_->memory) return count;
  CVodeGetNumSteps(core_->memory, &count.steps);
  CVodeGetNumRhsEvals(core_->memory, &count.evaluations);
  CVodeGetNumJacEvals(core_->memory, &count.jacobians);
  return count;
}

}  // namespace rosin::solvers::steps
