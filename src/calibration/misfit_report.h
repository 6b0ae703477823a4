// What a fit keeps of its misfits: a table of all points, and the conflicts with priors.
#ifndef LACUNA_CALIBRATION_MISFIT_REPORT_H_
#define LACUNA_CALIBRATION_MISFIT_REPORT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_record.h"
#include "record/csv_table.h"

namespace lacuna {

// misfit.csv: for every point in every frame, the measured place and predicted − measured, m. The
// place of a patch is the mean of its scanned points, and its difference is along the surface
// normal.
CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits);

// Conflicts of the fit with its priors, as sentences: points far from their given places, a clock
// or a holding force far outside its prior, scans that lose the model.
std::vector<std::string> Strains(const CalibrationProblem& problem,
                                 const std::vector<RecordingMisfit>& misfits);

// A summary of how a recording of scans was used. `noise`: σ of one scanned point, m.
FittedScan DescribeScan(const RecordingMisfit& misfit, const Eigen::Matrix3Xd& places,
                        double noise);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MISFIT_REPORT_H_
