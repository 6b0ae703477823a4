#include "calibration/side_by_side.h"

#include "calibration/calibration_problem.h"
#include "core/parallel.h"

namespace lacuna {

void ForEachStudy(const CalibrationProblem& problem, int64_t count,
                  const std::function<void(int64_t k)>& study) {
  int64_t fitted = 0;
  for (const RecordingModel& recording : problem.models()) fitted += recording.recording().fitted;
  if (fitted > 1) {
    for (int64_t k = 0; k < count; ++k) study(k);
  } else {
    ParallelFor(count, 1, study);
  }
}

}  // namespace lacuna
