/// CVODE and ARKODE under one set of names, so that what is done with them is written once.
#pragma once
#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>

namespace bench {

/// Variable-order BDF.
struct Cvode {
  static void* create(ARKRhsFn rate, N_Vector y, SUNContext context) {
    void* memory = CVodeCreate(CV_BDF, context);
    CVodeInit(memory, rate, 0, y);
    return memory;
  }
  static constexpr auto free = CVodeFree;
  static constexpr auto set_errors = CVodeSetErrHandlerFn;
  static constexpr auto set_data = CVodeSetUserData;
  static constexpr auto set_tolerances = CVodeSVtolerances;
  static constexpr auto set_linear_solver = CVodeSetLinearSolver;
  static constexpr auto set_jacobian = CVodeSetJacFn;
  static constexpr auto set_most_steps = CVodeSetMaxNumSteps;
  static constexpr auto set_most_error_failures = CVodeSetMaxErrTestFails;
  static constexpr auto set_most_newton_failures = CVodeSetMaxConvFails;
  static constexpr auto set_root = CVodeRootInit;
  static constexpr auto set_root_direction = CVodeSetRootDirection;
  static constexpr auto no_root_warning = CVodeSetNoInactiveRootWarn;
  static constexpr auto set_longest_step = CVodeSetMaxStep;
  static constexpr auto set_stop_time = CVodeSetStopTime;
  static constexpr auto steps = CVodeGetNumSteps;
  static constexpr auto advance = CVode;
  static constexpr auto derivative = CVodeGetDky;
  static constexpr auto flag_name = CVodeGetReturnFlagName;
};
/// ARKODE's default diagonally implicit Runge-Kutta method, order 4.
struct Arkode {
  static void* create(ARKRhsFn rate, N_Vector y, SUNContext context) {
    return ARKStepCreate(nullptr, rate, 0, y, context);
  }
  static constexpr auto free = ARKStepFree;
  static constexpr auto set_errors = ARKStepSetErrHandlerFn;
  static constexpr auto set_data = ARKStepSetUserData;
  static constexpr auto set_tolerances = ARKStepSVtolerances;
  static constexpr auto set_linear_solver = ARKStepSetLinearSolver;
  static constexpr auto set_jacobian = ARKStepSetJacFn;
  static constexpr auto set_most_steps = ARKStepSetMaxNumSteps;
  static constexpr auto set_most_error_failures = ARKStepSetMaxErrTestFails;
  static constexpr auto set_most_newton_failures = ARKStepSetMaxConvFails;
  static constexpr auto set_root = ARKStepRootInit;
  static constexpr auto set_root_direction = ARKStepSetRootDirection;
  static constexpr auto no_root_warning = ARKStepSetNoInactiveRootWarn;
  static constexpr auto set_longest_step = ARKStepSetMaxStep;
  static constexpr auto set_stop_time = ARKStepSetStopTime;
  static constexpr auto steps = ARKStepGetNumSteps;
  static constexpr auto advance = ARKStepEvolve;
  static constexpr auto derivative = ARKStepGetDky;
  static constexpr auto flag_name = ARKStepGetReturnFlagName;
};
static_assert(CV_ONE_STEP == ARK_ONE_STEP && CV_ROOT_RETURN == ARK_ROOT_RETURN);

}  // namespace bench
