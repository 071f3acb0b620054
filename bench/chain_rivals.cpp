/// CVODE's side of the chain: rates, banded Jacobian.
#include "bench/chain_rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

#include <cmath>
#include <cstdlib>
#include <sundials/sundials_context.hpp>

namespace bench {
namespace {

// Displacement i is at 2 i, its velocity at 2 i + 1.
struct Friction {
  double value, slope;
};
Friction friction(const ChainProblem& p, double v) {
  const double r = v / p.v1, fall = 1 / (1 + r * r), size = std::sqrt(v * v + p.v0 * p.v0), turn = v / size;
  const double level = p.mu_d + (p.mu_s - p.mu_d) * fall;
  const double level_slope = -(p.mu_s - p.mu_d) * fall * fall * 2 * r / p.v1;
  return {level * turn, level_slope * turn + level * p.v0 * p.v0 / (size * size * size)};
}

int rate(realtype, N_Vector y, N_Vector f, void* data) {
  const auto& p = *static_cast<const ChainProblem*>(data);
  const double* a = N_VGetArrayPointer(y);
  double* out = N_VGetArrayPointer(f);
  const int n = int(p.start.size());
  for (int i = 0; i < n; ++i) {
    double force = -p.pull * a[2 * i] + friction(p, p.speed - a[2 * i + 1]).value;
    if (i > 0) force += p.coupling * (a[2 * i - 2] - a[2 * i]);
    if (i + 1 < n) force += p.coupling * (a[2 * i + 2] - a[2 * i]);
    out[2 * i] = a[2 * i + 1], out[2 * i + 1] = force;
  }
  return 0;
}

int jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
  const auto& p = *static_cast<const ChainProblem*>(data);
  const double* a = N_VGetArrayPointer(y);
  const int n = int(p.start.size());
  SUNMatZero(J);
  for (int i = 0; i < n; ++i) {
    const int row = 2 * i + 1, neighbours = (i > 0) + (i + 1 < n);
    SM_ELEMENT_B(J, 2 * i, row) = 1;
    SM_ELEMENT_B(J, row, row) = -friction(p, p.speed - a[row]).slope;
    SM_ELEMENT_B(J, row, 2 * i) = -p.pull - neighbours * p.coupling;
    if (i > 0) SM_ELEMENT_B(J, row, 2 * i - 2) = p.coupling;
    if (i + 1 < n) SM_ELEMENT_B(J, row, 2 * i + 2) = p.coupling;
  }
  return 0;
}

}  // namespace

ChainMotion follow_cvode_chain(const ChainProblem& p, double tolerance) {
  ChainMotion found;
  sundials::Context context;
  const int n = int(p.start.size());
  N_Vector y = N_VNew_Serial(2 * n, context);
  for (int i = 0; i < n; ++i) NV_Ith_S(y, 2 * i) = p.start[std::size_t(i)], NV_Ith_S(y, 2 * i + 1) = p.speed;
  void* memory = CVodeCreate(CV_BDF, context);
  CVodeInit(memory, rate, 0, y);
  CVodeSetErrHandlerFn(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  CVodeSetUserData(memory, const_cast<ChainProblem*>(&p));
  CVodeSStolerances(memory, tolerance, 0.1 * tolerance);
  constexpr int above = 1, below = 3;  // a velocity's row reaches from the displacement before to the one behind
  SUNMatrix matrix = SUNBandMatrix(2 * n, above, below, context);
  SUNLinearSolver linear = SUNLinSol_Band(y, matrix, context);
  CVodeSetLinearSolver(memory, linear, matrix);
  CVodeSetJacFn(memory, jacobian);
  CVodeSetMaxNumSteps(memory, 10'000'000);
  CVodeSetStopTime(memory, p.duration);
  double t = 0;
  const int flag = CVode(memory, p.duration, y, &t, CV_NORMAL);
  if (flag < 0) {
    char* name = CVodeGetReturnFlagName(flag);
    found.failure = name;
    std::free(name);
  }
  CVodeGetNumSteps(memory, &found.steps);
  for (int i = 0; i < n; ++i) found.q.push_back(NV_Ith_S(y, 2 * i));
  CVodeFree(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  return found;
}

}  // namespace bench
