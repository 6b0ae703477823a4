// A fit that a test needs before it can look at something else.
#ifndef LACUNA_TESTS_SUPPORT_SILENT_FIT_H_
#define LACUNA_TESTS_SUPPORT_SILENT_FIT_H_

#include "calibration/calibration_fits.h"
#include "support/silent_progress.h"

namespace lacuna {

// FitFromStart() without a display of its progress. A fit that failed says so in `usable`.
inline Calibration FitSilently(const CalibrationProblem& problem) {
  SilentProgress progress;
  return FitFromStart(problem, &progress);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_SILENT_FIT_H_
