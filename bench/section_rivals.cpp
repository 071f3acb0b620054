/// CVODE's slip, and stick by hand.
#include "bench/section_rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sundials/sundials_context.hpp>

namespace bench {
namespace {

struct Slip {
  const ForcedBelt* p;
  double direction;  ///< of the slip V − x′
  bool disturb;
};

double force(const ForcedBelt& p, double t) { return p.amplitude * std::cos(p.frequency * t); }

int rate(realtype t, N_Vector y, N_Vector f, void* data) {
  const auto& [p, s, disturb] = *static_cast<const Slip*>(data);
  const double x = NV_Ith_S(y, 0), v = NV_Ith_S(y, 1), w = p->speed - v, fall = 1 + p->delta * std::abs(w);
  NV_Ith_S(f, 0) = v;
  NV_Ith_S(f, 1) = -x + s / fall + force(*p, t);
  if (disturb) {
    NV_Ith_S(f, 2) = NV_Ith_S(y, 3);
    NV_Ith_S(f, 3) = -NV_Ith_S(y, 2) + s * std::copysign(p->delta, w) / (fall * fall) * NV_Ith_S(y, 3);
  }
  return 0;
}
int root(realtype, N_Vector y, realtype* g, void* data) {
  const auto& [p, s, disturb] = *static_cast<const Slip*>(data);
  g[0] = s * (p->speed - NV_Ith_S(y, 1));
  return 0;
}

}  // namespace

SectionPoints follow_belt_by_cvode(const ForcedBelt& p, int periods, double tolerance, bool disturb) {
  SectionPoints found;
  sundials::Context context;
  const int size = disturb ? 4 : 2;
  N_Vector y = N_VNew_Serial(size, context);
  Slip slip{&p, 0, disturb};
  void* memory = CVodeCreate(CV_ADAMS, context);
  CVodeInit(memory, rate, 0, y);
  CVodeSetErrHandlerFn(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  CVodeSetUserData(memory, &slip);
  CVodeSStolerances(memory, tolerance, 0.1 * tolerance);
  SUNNonlinearSolver iteration = SUNNonlinSol_FixedPoint(y, 0, context);
  CVodeSetNonlinearSolver(memory, iteration);
  CVodeSetMaxNumSteps(memory, 20'000);
  CVodeRootInit(memory, 1, root);
  const int falling = -1;
  CVodeSetRootDirection(memory, const_cast<int*>(&falling));
  CVodeSetNoInactiveRootWarn(memory);

  const double period = 2 * M_PI / p.frequency;
  double t = 0, x = 0, dx = 1, dv = 0;
  bool stuck = true;
  const auto held = [&] { return x - force(p, t); };
  long slips = 0;
  const auto begin_slip = [&] {
    if (++slips > 100L * periods) found.failure = "slip begins and ends without end";
    slip.direction = held() > 0 ? 1 : -1, stuck = false;
    NV_Ith_S(y, 0) = x, NV_Ith_S(y, 1) = p.speed;
    if (disturb) {
      const double grown = std::hypot(dx, dv);
      found.growth += std::log(grown);
      NV_Ith_S(y, 2) = dx / grown, NV_Ith_S(y, 3) = dv / grown;
    }
    CVodeReInit(memory, t, y);
  };
  for (int n = 1; n <= periods && found.failure.empty(); ++n) {
    const double end = n * period;
    while (t < end && found.failure.empty()) {
      if (stuck) {
        const double x0 = x - p.speed * t, step = period / 64;
        const auto margin = [&](double at) { return 1 - std::abs(x0 + p.speed * at - force(p, at)); };
        double low = t, high = std::min(t + step, end);
        while (margin(high) > 0 && high < end) low = high, high = std::min(high + step, end);
        const bool released = margin(high) <= 0;
        for (int i = 0; released && i < 52; ++i) {
          const double middle = 0.5 * (low + high);
          (margin(middle) > 0 ? low : high) = middle;
        }
        t = high, x = x0 + p.speed * t;
        if (released) begin_slip();
        continue;
      }
      CVodeSetStopTime(memory, end);
      const int flag = CVode(memory, end, y, &t, CV_NORMAL);
      if (flag < 0) {
        char* name = CVodeGetReturnFlagName(flag);
        found.failure = name;
        std::free(name);
        break;
      }
      x = NV_Ith_S(y, 0);
      if (flag != CV_ROOT_RETURN) continue;
      if (disturb) dx = NV_Ith_S(y, 2), dv = NV_Ith_S(y, 3);
      if (std::abs(held()) <= 1) {
        stuck = true, dv = 0;
        continue;
      }
      // Slip turns round: the acceleration jumps, and the moment of the jump moves with the disturbance.
      const double before = slip.direction - held(), after = (held() > 0 ? 1 : -1) - held();
      dv *= after / before;
      begin_slip();
    }
    found.x.push_back(x);
  }
  if (disturb && !stuck) dx = NV_Ith_S(y, 2), dv = NV_Ith_S(y, 3);
  if (disturb) found.growth += std::log(std::hypot(dx, dv));
  CVodeFree(&memory);
  SUNNonlinSolFree(iteration);
  N_VDestroy(y);
  return found;
}

}  // namespace bench
