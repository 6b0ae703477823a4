#include "fit/stop_on_interrupt.h"

#include <ceres/iteration_callback.h>

#include "core/interrupt.h"

namespace lacuna {
namespace {

class Stop : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return InterruptRequested() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
};

}  // namespace

std::unique_ptr<ceres::IterationCallback> StopOnInterrupt() { return std::make_unique<Stop>(); }

}  // namespace lacuna
