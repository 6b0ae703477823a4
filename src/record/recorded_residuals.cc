#include "record/recorded_residuals.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "core/error.h"
#include "record/run_record.h"

namespace lacuna {

RecordedResiduals ReadResiduals(const CsvTable& table, int recording,
                                const std::filesystem::path& file) {
  const Eigen::VectorXd& recordings = ColumnOf(table, "recording", file);
  const Eigen::VectorXd& frame = ColumnOf(table, "frame", file);
  const Eigen::VectorXd& time = ColumnOf(table, "time_s", file);
  const Eigen::VectorXd& point = ColumnOf(table, "marker", file);
  const Eigen::VectorXd& fitted = ColumnOf(table, "fitted", file);
  RecordedResiduals result;
  std::map<int, Eigen::Index> column_of;
  int points = 0;
  std::vector<double> times;
  for (Eigen::Index row = 0; row < recordings.size(); ++row) {
    if (recordings[row] != recording) continue;
    points = std::max(points, static_cast<int>(point[row]) + 1);
    const int number = static_cast<int>(frame[row]);
    const bool is_new =
        column_of.emplace(number, static_cast<Eigen::Index>(result.frames.size())).second;
    if (!is_new) continue;
    if (!times.empty() && time[row] <= times.back())
      throw InputError({file.string()}, "its frames are not in chronological order");
    result.frames.push_back(number);
    times.push_back(time[row]);
    result.fitted.push_back(fitted[row] != 0);
  }
  const Eigen::Index frames = static_cast<Eigen::Index>(times.size());
  result.times = Eigen::Map<const Eigen::VectorXd>(times.data(), frames);
  result.measured = Eigen::MatrixXd::Constant(3 * points, frames, kNotMeasured);
  result.difference = result.measured;
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](const std::string& name) -> const Eigen::VectorXd& {
      return ColumnOf(table, fmt::format("{}_{}_m", name, "xyz"[axis]), file);
    };
    const Eigen::VectorXd &measured = coordinate("measured"),
                          &difference = coordinate("difference");
    for (Eigen::Index row = 0; row < recordings.size(); ++row) {
      if (recordings[row] != recording) continue;
      const Eigen::Index column = column_of.at(static_cast<int>(frame[row]));
      const Eigen::Index at = 3 * static_cast<Eigen::Index>(point[row]) + axis;
      if (at < 0) throw InputError({file.string()}, "the number of a marker is negative");
      result.measured(at, column) = measured[row];
      result.difference(at, column) = difference[row];
    }
  }
  const auto read_scalars = [&](const char* name, Eigen::MatrixXd* scalars) {
    const Eigen::VectorXd* values = FindColumn(table, name);
    if (values == nullptr) return;
    *scalars = Eigen::MatrixXd::Constant(points, frames, kNotMeasured);
    for (Eigen::Index row = 0; row < recordings.size(); ++row)
      if (recordings[row] == recording)
        (*scalars)(static_cast<Eigen::Index>(point[row]),
                   column_of.at(static_cast<int>(frame[row]))) = (*values)[row];
  };
  read_scalars("along_normal_m", &result.along_normal);
  read_scalars("sigma_m", &result.sigma);
  return result;
}

std::vector<FrameRange> FittedAndHeldOutRanges(const RecordedResiduals& residuals) {
  std::vector<FrameRange> ranges;
  const int frames = static_cast<int>(residuals.frames.size());
  for (int first = 0; first < frames;) {
    int last = first;
    while (last + 1 < frames && residuals.fitted[last + 1] == residuals.fitted[first]) ++last;
    ranges.push_back({residuals.fitted[first] != 0, first, last});
    first = last + 1;
  }
  return ranges;
}

}  // namespace lacuna
