// What is kept of a fit's misfits beside their sizes.
#ifndef LACUNA_CALIBRATION_MISFIT_REPORT_H_
#define LACUNA_CALIBRATION_MISFIT_REPORT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_record.h"
#include "record/csv_table.h"

namespace lacuna {

// misfit.csv: every point of every frame, measured place and predicted − measured, m. The
// difference of a patch is its error times the surface's normal, its place the mean of its scanned
// points.
CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits);

// What the fit took for granted against its prior, in sentences: points far from where the
// recording has them, a clock or a hold far from what was allowed, scans that lose the model.
std::vector<std::string> Strains(const CalibrationProblem& problem,
                                 const std::vector<RecordingMisfit>& misfits);

// Of a recording of scans, σ being the noise of one scanned point.
FittedScan DescribeScan(const RecordingMisfit& misfit, const Eigen::Matrix3Xd& places,
                        double noise);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MISFIT_REPORT_H_
