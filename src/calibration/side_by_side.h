// Several computations that predict the recordings of one study.
#ifndef LACUNA_CALIBRATION_SIDE_BY_SIDE_H_
#define LACUNA_CALIBRATION_SIDE_BY_SIDE_H_

#include <cstdint>
#include <functional>

namespace lacuna {

class CalibrationProblem;

// Calls study(k) for 0 ≤ k < count. The calls must be independent of each other. They run side by
// side if the problem has one recording to fit, and otherwise one after another: a prediction of
// several recordings has work for several threads already, and computations of different lengths
// would leave some of them without any. The first exception of a call is thrown again.
void ForEachStudy(const CalibrationProblem& problem, int64_t count,
                  const std::function<void(int64_t k)>& study);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_SIDE_BY_SIDE_H_
