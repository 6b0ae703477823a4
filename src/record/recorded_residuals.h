// Measured and predicted places of one recording's points, as a fit wrote them to misfit.csv.
#ifndef LACUNA_RECORD_RECORDED_RESIDUALS_H_
#define LACUNA_RECORD_RECORDED_RESIDUALS_H_

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "record/csv_table.h"

namespace lacuna {

// m points over n frames. Matrices are 3m × n, m, in its coordinates: x, y, z of a point in
// three rows, frames in chronological order in the columns, NaN where a point was not observed.
struct RecordedResiduals {
  std::vector<int> frames;     // n, numbers of the recording's frames
  Eigen::VectorXd times;       // n, s, ascending
  std::vector<char> fitted;    // n; 0: held out
  Eigen::MatrixXd measured;    // measured places; for a patch the mean of its scanned points
  Eigen::MatrixXd difference;  // predicted − measured; for a patch along its normal
  // m × n, m; NaN where a point was not observed. Empty in a table of an earlier version.
  Eigen::MatrixXd along_normal;  // the signed difference of a patch; NaN for markers
  Eigen::MatrixXd sigma;  // noise of a point: σ of each coordinate, of a patch along its normal

  int PointCount() const { return static_cast<int>(measured.rows() / 3); }
};

// Reads the rows of recording number `recording`. Throws InputError naming `file` when a column is
// absent, other than the last two, a point's number is negative or frames are not in chronological
// order. A recording without rows has no frames.
RecordedResiduals ReadResiduals(const CsvTable& table, int recording,
                                const std::filesystem::path& file);

// A range of columns, first to last inclusive, that are all fitted or all held out.
struct FrameRange {
  bool fitted = true;
  int first = 0, last = 0;
  int Count() const { return last - first + 1; }
};

// The longest such ranges in chronological order: the fitted frames of a recording come before
// those that are held out.
std::vector<FrameRange> FittedAndHeldOutRanges(const RecordedResiduals& residuals);

}  // namespace lacuna

#endif  // LACUNA_RECORD_RECORDED_RESIDUALS_H_
