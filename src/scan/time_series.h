// Vectors that change with time, as files give them: the path of a grip, a measured force.
#ifndef LACUNA_SCAN_TIME_SERIES_H_
#define LACUNA_SCAN_TIME_SERIES_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/delimited_table.h"

namespace lacuna {

struct TimeSeries {
  DelimitedTable table;     // the file it was read from
  Eigen::VectorXd times;    // k, s, ascending
  Eigen::Matrix3Xd values;  // 3 × k, SI, finite
};

// Reads `file` (.npy or text), the columns `x`, `y`, `z` (names or numbers from 1; default 1, 2, 3)
// in multiples of `unit` (SI) and the column `time` in `time_unit` (default s). Without `time` the
// file must have one row for each of `frame_times`, the times of all frames in the files (s).
// Throws InputError naming file and row when a value is not finite or the times do not ascend.
TimeSeries ReadTimeSeries(const Config& config, const DataLocation& data,
                          const std::vector<double>& frame_times, double unit);

// The SI value of one of the unit at `key`, e.g. 1e-3 for "mm".
double ReadUnit(const Config& config, const std::string& key, const Dimension& dimension,
                const std::string& default_unit);

// Three columns of a table, multiplied by `unit`: 3 × rows.
Eigen::Matrix3Xd VectorColumns(const DelimitedTable& table, const std::array<std::string, 3>& names,
                               double unit);

// Both interpolate `values` (3 × k) given at `times` (k, ascending) and stay constant before the
// first time and after the last. The first is piecewise linear. The second is a cubic Hermite
// spline whose velocity at each time is that of the parabola through it and its two neighbours, so
// that the velocity is continuous.
Eigen::Vector3d InterpolateLinearly(const Eigen::VectorXd& times, const Eigen::Matrix3Xd& values,
                                    double time);
Eigen::Vector3d InterpolateSmoothly(const Eigen::VectorXd& times, const Eigen::Matrix3Xd& values,
                                    double time);

// Writes a CSV with the columns time, x, y, z in SI.
void WriteTimeSeries(const std::filesystem::path& file, const Eigen::VectorXd& times,
                     const Eigen::Matrix3Xd& values);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TIME_SERIES_H_
