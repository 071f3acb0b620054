/// CVODE's slip pieces between roots, and the balance of forces at each.
#include "bench/stick_slip_rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sundials/sundials_context.hpp>

namespace bench {
namespace {

struct Mode {
  const StickSlip* p;
  double direction;  ///< of motion; 0: stick
};

double load(const StickSlip& p, double t) { return p.Nc + p.Nv * std::cos(p.wn * t); }
double balance(const StickSlip& p, double t, double x) { return p.P * std::cos(p.we * t) - p.k * x; }

int rate(realtype t, N_Vector y, N_Vector f, void* data) {
  const auto& [p, s] = *static_cast<const Mode*>(data);
  const double x = NV_Ith_S(y, 0), v = NV_Ith_S(y, 1);
  NV_Ith_S(f, 0) = s == 0 ? 0 : v;
  NV_Ith_S(f, 1) = s == 0 ? 0 : (balance(*p, t, x) - p->c * v - s * p->muk * load(*p, t)) / p->m;
  return 0;
}
int jacobian(realtype, N_Vector, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
  const auto& [p, s] = *static_cast<const Mode*>(data);
  SM_ELEMENT_D(J, 0, 0) = 0, SM_ELEMENT_D(J, 0, 1) = s == 0 ? 0 : 1;
  SM_ELEMENT_D(J, 1, 0) = s == 0 ? 0 : -p->k / p->m, SM_ELEMENT_D(J, 1, 1) = s == 0 ? 0 : -p->c / p->m;
  return 0;
}
int root(realtype t, N_Vector y, realtype* g, void* data) {
  const auto& [p, s] = *static_cast<const Mode*>(data);
  g[0] = s == 0 ? p->mus * load(*p, t) - std::abs(balance(*p, t, NV_Ith_S(y, 0))) : s * NV_Ith_S(y, 1);
  return 0;
}

}  // namespace

Displacements follow_cvode_events(const StickSlip& p, bool adams, double tolerance) {
  Displacements found;
  sundials::Context context;
  N_Vector y = N_VNew_Serial(2, context), absolute = N_VNew_Serial(2, context);
  NV_Ith_S(y, 0) = p.x0, NV_Ith_S(y, 1) = 0;
  NV_Ith_S(absolute, 0) = 1e-2 * tolerance * p.x0;
  NV_Ith_S(absolute, 1) = 1e-2 * tolerance * p.x0 * std::sqrt(p.k / p.m);
  double t = 0;
  const auto at_rest = [&] {
    const double R = balance(p, t, NV_Ith_S(y, 0));
    return std::abs(R) <= p.mus * load(p, t) ? 0.0 : R > 0 ? 1.0 : -1.0;
  };
  Mode mode{&p, at_rest()};
  void* memory = CVodeCreate(adams ? CV_ADAMS : CV_BDF, context);
  CVodeInit(memory, rate, 0, y);
  CVodeSetErrHandlerFn(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  CVodeSetUserData(memory, &mode);
  CVodeSVtolerances(memory, tolerance, absolute);
  SUNMatrix matrix = SUNDenseMatrix(2, 2, context);
  SUNLinearSolver linear = SUNLinSol_Dense(y, matrix, context);
  CVodeSetLinearSolver(memory, linear, matrix);
  CVodeSetJacFn(memory, jacobian);
  CVodeSetMaxNumSteps(memory, 1'000'000);
  CVodeRootInit(memory, 1, root);
  const int falling = -1;
  CVodeSetRootDirection(memory, const_cast<int*>(&falling));
  CVodeSetNoInactiveRootWarn(memory);
  // In stick nothing but this limits the steps. With 0.5 in place of 0.1 a double root of the fourth case is missed.
  const double fastest = std::max({p.we, p.wn, std::sqrt(p.k / p.m)});
  const auto bound_steps = [&] { CVodeSetMaxStep(memory, (mode.direction == 0 ? 0.1 : 0.5) / fastest); };
  bound_steps();
  for (int i = 0; i < sample_count && found.failure.empty();) {
    const double next = sample_interval * (i + 1);
    CVodeSetStopTime(memory, next);
    const int flag = CVode(memory, next, y, &t, CV_NORMAL);
    if (flag < 0) {
      char* name = CVodeGetReturnFlagName(flag);
      found.failure = name;
      std::free(name);
    } else if (flag == CV_ROOT_RETURN) {
      NV_Ith_S(y, 1) = 0;
      mode.direction = mode.direction == 0 ? (balance(p, t, NV_Ith_S(y, 0)) > 0 ? 1 : -1) : at_rest();
      bound_steps();
      CVodeReInit(memory, t, y);
    } else {
      found.x[static_cast<std::size_t>(i++)] = NV_Ith_S(y, 0);
    }
  }
  CVodeFree(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  N_VDestroy(absolute);
  return found;
}

}  // namespace bench
