// What `fit`, `add` and `diagnose` print of a fit.
#ifndef LACUNA_APP_FIT_REPORT_H_
#define LACUNA_APP_FIT_REPORT_H_

#include "calibration/calibration_run.h"

namespace lacuna {

// Parameters with intervals, and errors per recording.
void PrintCalibration(const CalibrationRecord& record);

}  // namespace lacuna

#endif  // LACUNA_APP_FIT_REPORT_H_
