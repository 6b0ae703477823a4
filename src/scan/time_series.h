// Quantities that change with time, as files give them: the path of a grip, a measured force.
#ifndef LACUNA_SCAN_TIME_SERIES_H_
#define LACUNA_SCAN_TIME_SERIES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/delimited_table.h"

namespace lacuna {

struct TimeSeries {
  DelimitedTable table;    // the file it was read from
  Eigen::VectorXd times;   // k, s, ascending
  Eigen::MatrixXd values;  // c × k, SI, finite
  std::string gaps;        // what was left out or averaged (Rows::kMeasured); empty: nothing
};

// The unit of columns, which stands at `key` of a mapping in recording.yaml.
struct ColumnUnit {
  double si = 1;  // of one such unit
  Dimension dimension;
  std::string key, symbol;
};
// Throws InputError where the unit is unknown or has another dimension.
ColumnUnit ReadColumnUnit(const Config& config, const std::string& key, const Dimension& dimension,
                          const std::string& default_unit);

// Whether each row of a file must have a value and a time of its own. Of measurements, rows without
// a value are left out, and those of equal times, which were rounded, are averaged.
enum class Rows { kAll, kMeasured };

// Reads `file` (.npy or text): the columns `names` (names, or numbers from 1) in `unit`, and the
// column `time` in `time_unit` (default s). Without `time` the file must have one row for each of
// `frames`. With `from: headers` in place of `file` the values are those of these names in the
// headers of the frame files (table_header.h). Throws InputError naming file and line (of an .npy
// file: row) when it has no rows, a value is not finite or the times do not ascend, when a column
// is that of the times, too, and when the table gives another unit (RefuseOtherUnit).
TimeSeries ReadColumns(const Config& config, const DataLocation& data, const FrameData& frames,
                       const std::vector<std::string>& names, const ColumnUnit& unit, Rows rows);

// ReadColumns() for a vector, 3 × rows: the components that `x`, `y`, `z` name, or the one along
// `along` in the column `value` (component_columns.h); the others are 0. Where none is named, the
// columns are called fx, fy, fz, of a force, or x, y, z; those of a table without names are 1,
// 2, 3. Throws InputError, too, where a component that is not named may be meant, since the table
// has a column with its usual name or no names at all.
TimeSeries ReadVectorSeries(const Config& config, const DataLocation& data, const FrameData& frames,
                            const ColumnUnit& unit, Rows rows);

// The SI value of one of the unit at `key`, e.g. 1e-3 for "mm".
double ReadUnit(const Config& config, const std::string& key, const Dimension& dimension,
                const std::string& default_unit);

// The place of a row for messages: "load.csv:7", or "load.npy: row 7" where the file is no text.
std::string PlaceOfRow(const DelimitedTable& table, Eigen::Index row);

// Columns of a table, multiplied by `unit`: names × rows.
Eigen::MatrixXd ColumnsOf(const DelimitedTable& table, const std::vector<std::string>& names,
                          double unit);

// Interpolates `values` (c × k) given at `times` (k, ascending) linearly. Before the first time and
// after the last they are constant.
Eigen::VectorXd InterpolateLinearly(const Eigen::VectorXd& times,
                                    const Eigen::Ref<const Eigen::MatrixXd>& values, double time);

// Writes a CSV with the column time and those of `values` (one row for each of `names`), in SI.
void WriteTimeSeries(const std::filesystem::path& file, const Eigen::VectorXd& times,
                     const Eigen::Ref<const Eigen::MatrixXd>& values,
                     const std::vector<std::string>& names = {"x", "y", "z"});

}  // namespace lacuna

#endif  // LACUNA_SCAN_TIME_SERIES_H_
