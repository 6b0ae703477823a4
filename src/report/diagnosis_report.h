// The report of a diagnosis, made from records alone: what `diagnose` and `info` print.
#ifndef LACUNA_REPORT_DIAGNOSIS_REPORT_H_
#define LACUNA_REPORT_DIAGNOSIS_REPORT_H_

#include <filesystem>
#include <string>

#include "record/calibration_record.h"
#include "record/diagnosis_record.h"

namespace lacuna {

// The verdict with its reasons, the noise, the tables of effects and nuisances, and what to do
// next, for a terminal of 100 columns. `fit` is what was diagnosed, `run` the run's folder as the
// user names it.
std::string DiagnosisReport(const DiagnosisRecord& diagnosis, const CalibrationRecord& fit,
                            const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_REPORT_DIAGNOSIS_REPORT_H_
