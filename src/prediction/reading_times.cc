#include "prediction/reading_times.h"

#include <algorithm>

namespace lacuna {

std::vector<ReadingTime> ReadingTimesOf(const std::vector<double>& frame_times,
                                        const std::vector<std::vector<double>>& cell_times) {
  std::vector<ReadingTime> readings;
  for (size_t f = 0; f < frame_times.size(); ++f) readings.push_back({frame_times[f], f, true, {}});
  for (size_t cell = 0; cell < cell_times.size(); ++cell) {
    const std::vector<double>& own = cell_times[cell];
    for (size_t f = 0; own.empty() && f < frame_times.size(); ++f)
      readings[f].cells.push_back(cell);
    for (size_t f = 0; f < own.size(); ++f) readings.push_back({own[f], f, false, {cell}});
  }
  std::stable_sort(readings.begin(), readings.end(),
                   [](const ReadingTime& a, const ReadingTime& b) { return a.time < b.time; });
  return readings;
}

std::vector<double> Delayed(std::vector<double> times, double delay) {
  for (double& time : times) time -= delay;
  return times;
}

std::vector<double> TimesOf(const std::vector<ReadingTime>& readings) {
  std::vector<double> times;
  for (const ReadingTime& reading : readings) times.push_back(reading.time);
  return times;
}

}  // namespace lacuna
