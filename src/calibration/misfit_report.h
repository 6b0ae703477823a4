// The details of a fit's residuals that a run keeps.
#ifndef LACUNA_CALIBRATION_MISFIT_REPORT_H_
#define LACUNA_CALIBRATION_MISFIT_REPORT_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/held_out_misfit.h"
#include "record/calibration_record.h"
#include "record/csv_table.h"

namespace lacuna {

// The table misfit.csv: for each point of each frame of each recording, the measured place and the
// difference predicted − measured, m. For a patch of a surface the measured place is the mean of
// its scanned points, and the difference is the residual along the surface normal, which is a
// column of its own, times that normal. The last column is the noise σ of the point in that frame,
// m: of each coordinate, or of a patch along its normal; it is smaller for a point of larger weight
// and for a patch of more scanned points. Difference and σ are NaN where the point was not
// observed.
CsvTable MisfitTable(const CalibrationProblem& problem,
                     const std::vector<RecordingMisfit>& misfits);

// What the record keeps of a recording of scans. `places` are those of the patches on the
// undeformed object, m. `noise`: σ of one scanned point, m.
FittedScan DescribeScan(const RecordingMisfit& misfit, const Eigen::Matrix3Xd& places,
                        double noise);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MISFIT_REPORT_H_
