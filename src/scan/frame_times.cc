#include "scan/frame_times.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "scan/column_units.h"
#include "scan/delimited_table.h"
#include "scan/marker_tracks.h"
#include "scan/time_series.h"

namespace lacuna {
namespace {

void CheckAscending(const Config& config, const std::string& key,
                    const std::vector<double>& times) {
  for (size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1])) {
      config.Fail(
          key, fmt::format("frame {}: the time {} s is not later than that of the frame before", i,
                           times[i]));
    }
  }
}

std::vector<double> ReadTimesFile(const Config& config, const std::filesystem::path& file) {
  const DelimitedTable table = ReadDelimitedTable(file);
  const double unit =
      config.Choice<double>("unit", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}, "s");
  const Eigen::Index column = RequireColumn(table, config.Text("column", "1"));
  RefuseOtherUnit(table, column, unit, kTime, "unit");
  const Eigen::VectorXd times = unit * table.values.col(column);
  return {times.begin(), times.end()};
}

std::vector<double> ReadTimes(const Config& frames, size_t count,
                              const std::vector<double>& file_times, const DataLocation& data,
                              std::filesystem::path* times_file) {
  const bool has_rate = frames.Has("rate"), has_times = frames.Has("times");
  const std::optional<Config> file = frames.OptionalChild("times_file");
  if (has_rate + has_times + file.has_value() > 1) {
    frames.Fail("", "the times are given more than once: keep one of rate, times, times_file");
  }
  std::vector<double> times;
  std::string key = "rate";
  if (has_rate) {
    const double rate = frames.Quantity("rate", kRate, {1e-6, 1e9, false, false});
    for (size_t i = 0; i < count; ++i) times.push_back(i / rate);
  } else if (has_times) {
    key = "times";
    times = frames.Quantities("times", kTime, kAnyValue);
  } else if (file) {
    key = "times_file";
    *times_file = data.folder / file->Text("file");
    times = ReadTimesFile(*file, *times_file);
  } else if (!file_times.empty()) {
    times = file_times;
  } else if (count == 1) {
    times = {0};
  } else {
    // One file of all frames, of markers or of steps, may contain the times.
    frames.Fail("", fmt::format("no times are given: add rate, times or times_file{}",
                                frames.Has("file") ? ", or `columns: {time: NAME}` with the name "
                                                     "of a column of the file"
                                                   : ""));
  }
  if (times.size() != count) {
    frames.Fail(key, fmt::format("{} times for {} frames", times.size(), count));
  }
  CheckAscending(frames, key, times);
  return times;
}

// A sentence where the times that recording.yaml gives last longer or shorter than those of the
// files, which they replace; empty where they do not, or the files have none.
std::string DoubtOfReplacedTimes(const std::vector<double>& times,
                                 const std::vector<double>& in_files) {
  const size_t count = times.size();
  if (count < 2 || in_files.size() != count) return "";
  const double duration = times.back() - times.front();
  const double in_files_duration = in_files.back() - in_files.front();
  if (!(in_files_duration > 0) || !RatesDiffer(duration, in_files_duration, count - 1)) return "";
  return fmt::format(
      "the times in recording.yaml span {:.4g} s, those of the files {:.4g} s ({:.4g} Hz "
      "on average); the former are used",
      duration, in_files_duration, static_cast<double>(count - 1) / in_files_duration);
}

std::vector<int> ChooseFrames(const Config& frames, const std::vector<double>& times) {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  const double from = frames.Quantity("from", kTime, kAnyValue, -kForever);
  const double to = frames.Quantity("to", kTime, kAnyValue, kForever);
  const int every = frames.Integer("every", 1, 1'000'000, 1);
  std::vector<int> chosen;
  int within = 0;
  for (size_t i = 0; i < times.size(); ++i) {
    if (times[i] < from || times[i] > to) continue;
    if (within++ % every == 0) chosen.push_back(static_cast<int>(i));
  }
  if (chosen.empty()) frames.Fail("from", "no frame lies between from and to");
  return chosen;
}

}  // namespace

std::vector<double> FrameTimes::OfChosen() const {
  std::vector<double> times;
  for (const int i : chosen) times.push_back(in_files[i]);
  return times;
}

FrameTimes ReadFrameTimes(const Config& frames, size_t count, const std::vector<double>& file_times,
                          const DataLocation& data, std::vector<std::string>* warnings) {
  FrameTimes times;
  times.in_files = ReadTimes(frames, count, file_times, data, &times.file);
  const std::string doubt = DoubtOfReplacedTimes(times.in_files, file_times);
  if (!doubt.empty()) warnings->push_back(doubt);
  times.chosen = ChooseFrames(frames, times.in_files);
  return times;
}

}  // namespace lacuna
