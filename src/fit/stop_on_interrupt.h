// Ends a search of Ceres where the user has interrupted the program.
#ifndef LACUNA_FIT_STOP_ON_INTERRUPT_H_
#define LACUNA_FIT_STOP_ON_INTERRUPT_H_

#include <memory>

namespace ceres {
class IterationCallback;
}

namespace lacuna {

// To be called after each iteration; the caller of Ceres throws once Ceres has returned.
std::unique_ptr<ceres::IterationCallback> StopOnInterrupt();

}  // namespace lacuna

#endif  // LACUNA_FIT_STOP_ON_INTERRUPT_H_
