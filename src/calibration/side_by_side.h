// Several computations that predict the recordings of one study.
#ifndef LACUNA_CALIBRATION_SIDE_BY_SIDE_H_
#define LACUNA_CALIBRATION_SIDE_BY_SIDE_H_

#include <cstdint>
#include <functional>

namespace lacuna {

class CalibrationProblem;

// Calls study(k) for 0 ≤ k < count. The calls must be independent of each other. They run side by
// side if the problem has one recording to fit, and otherwise one after another, each with the
// recordings side by side. A call that begins when all threads are busy would predict its
// recordings one after another to its end: threads that become free help in loops that begin later
// (core/parallel.h), those within the prediction of one recording. The first exception of a call is
// thrown again.
void ForEachStudy(const CalibrationProblem& problem, int64_t count,
                  const std::function<void(int64_t k)>& study);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_SIDE_BY_SIDE_H_
