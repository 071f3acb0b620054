/// CVODE under a sine, and the first harmonic of the force.
#include "bench/response_rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmath>
#include <cstdlib>
#include <sundials/sundials_context.hpp>

namespace bench {
namespace {

struct Sine {
  const AgeingContact* contact;
  double amplitude, omega;
  double slip_rate(double t) const { return contact->V * (1 + amplitude * std::cos(omega * t)); }
};

int rate(realtype t, N_Vector y, N_Vector f, void* data) {
  const auto& sine = *static_cast<const Sine*>(data);
  NV_Ith_S(f, 0) = std::exp(-NV_Ith_S(y, 0)) - sine.slip_rate(t) / sine.contact->L;
  return 0;
}
int jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void*, N_Vector, N_Vector, N_Vector) {
  SM_ELEMENT_D(J, 0, 0) = -std::exp(-NV_Ith_S(y, 0));
  return 0;
}

SweptSine at_amplitude(const AgeingContact& p, double amplitude, double frequency, double tolerance) {
  constexpr int cycles = 4, per_cycle = 32, count = cycles * per_cycle;
  const double pi = std::acos(-1.0);
  Sine sine{&p, amplitude, 2 * pi * frequency};
  SweptSine found;
  sundials::Context context;
  N_Vector y = N_VNew_Serial(1, context);
  NV_Ith_S(y, 0) = std::log(p.L / p.V);
  void* memory = CVodeCreate(CV_ADAMS, context);
  CVodeInit(memory, rate, 0, y);
  CVodeSetErrHandlerFn(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  CVodeSetUserData(memory, &sine);
  CVodeSStolerances(memory, 1e-15, tolerance * amplitude);  // what counts is the change of ln θ
  SUNMatrix matrix = SUNDenseMatrix(1, 1, context);
  SUNLinearSolver linear = SUNLinSol_Dense(y, matrix, context);
  CVodeSetLinearSolver(memory, linear, matrix);
  CVodeSetJacFn(memory, jacobian);
  CVodeSetMaxNumSteps(memory, 10'000'000);
  const double settle = std::ceil(-std::log(tolerance) * p.L / p.V * frequency) / frequency;
  std::complex<double> sum = 0;
  double t = 0;
  for (int i = 0; i < count; ++i) {
    const double next = settle + i / (per_cycle * frequency);
    if (const int flag = CVode(memory, next, y, &t, CV_NORMAL); flag < 0) {
      char* name = CVodeGetReturnFlagName(flag);
      found.failure = name;
      std::free(name);
      break;
    }
    const double force =
        p.N * (p.mu0 + p.a * std::log(sine.slip_rate(next) / p.v0) + p.b * (std::log(p.v0 / p.L) + NV_Ith_S(y, 0)));
    sum += force * std::polar(2.0 / count, -sine.omega * next);
  }
  found.Z = sum / (amplitude * p.V);
  CVodeFree(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(y);
  return found;
}

}  // namespace

SweptSine swept_by_cvode(const AgeingContact& contact, double frequency, double tolerance) {
  constexpr double amplitude = 0.01;
  const auto full = at_amplitude(contact, amplitude, frequency, tolerance);
  auto half = at_amplitude(contact, amplitude / 2, frequency, tolerance);
  half.Z += (half.Z - full.Z) / 3.0;
  if (half.failure.empty()) half.failure = full.failure;
  return half;
}

}  // namespace bench
