// The report of a fit, made from its record alone: what `fit`, `add` and `info` print.
#ifndef LACUNA_REPORT_CALIBRATION_REPORT_H_
#define LACUNA_REPORT_CALIBRATION_REPORT_H_

#include <string>

#include "record/calibration_record.h"

namespace lacuna {

// A table of the parameters with their 95 % intervals, and the errors of each recording, for a
// terminal of 100 columns.
std::string CalibrationReport(const CalibrationRecord& record);

// CalibrationReport() in about a dozen lines: the parameters of the model and the errors, without
// nuisance parameters of the recordings, which are counted, as are conflicts with priors.
std::string CalibrationSummary(const CalibrationRecord& record);

// One sentence about a conflict between the fit and a prior.
std::string DescribePriorConflict(const PriorConflict& conflict);

}  // namespace lacuna

#endif  // LACUNA_REPORT_CALIBRATION_REPORT_H_
