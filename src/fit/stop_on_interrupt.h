// Ends a search of Ceres where the user has interrupted the program.
#ifndef LACUNA_FIT_STOP_ON_INTERRUPT_H_
#define LACUNA_FIT_STOP_ON_INTERRUPT_H_

#include <ceres/iteration_callback.h>

#include "core/interrupt.h"

namespace lacuna {

// To be called after each iteration; the caller of Ceres throws once Ceres has returned.
class StopOnInterrupt : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return InterruptRequested() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
};

}  // namespace lacuna

#endif  // LACUNA_FIT_STOP_ON_INTERRUPT_H_
