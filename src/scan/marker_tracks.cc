#include "scan/marker_tracks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/median.h"

namespace lacuna {

namespace {

void CheckTimes(const std::filesystem::path& file, const Eigen::VectorXd& times, double rate) {
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1])) {
      const bool is_equal = i > 0 && times[i] == times[i - 1];
      const std::string remedy =
          rate > 0 ? fmt::format(
                         "; the file states {:g} Hz: `rate: {:g} Hz` in recording.yaml "
                         "replaces its times",
                         rate, rate)
                   : "; `rate`, `times` or `times_file` in recording.yaml replace its times";
      throw InputError(
          {file.string()},
          fmt::format("frame {}: the time {} s is not later than that of the frame before{}{}", i,
                      times[i], is_equal ? ", perhaps because it was rounded" : "", remedy));
    }
  }
}

// Times with gaps contradict the rate only where most intervals do, too.
void WarnOfOtherRate(const std::filesystem::path& file, double rate, MarkerTracks* tracks) {
  const Eigen::Index count = tracks->times.size() - 1;
  if (!(rate > 0) || count < 1) return;
  std::vector<double> intervals;
  for (Eigen::Index k = 0; k < count; ++k)
    intervals.push_back(tracks->times[k + 1] - tracks->times[k]);
  const double typical = 1 / Median(std::move(intervals));
  const double mean = static_cast<double>(count) / (tracks->times[count] - tracks->times[0]);
  if (!RatesDiffer(typical, rate, static_cast<size_t>(count)) ||
      !RatesDiffer(mean, rate, static_cast<size_t>(count)))
    return;
  tracks->warnings.push_back(
      fmt::format("{}: its header states {:g} Hz, but its times follow each other at {:.4g} Hz; "
                  "its times are used; `rate` in recording.yaml overrides them",
                  file.string(), rate, typical));
}

}  // namespace

bool RatesDiffer(double a, double b, size_t count) {
  constexpr double kTolerance = 0.02;
  return std::abs(a - b) > std::max(kTolerance, 1 / static_cast<double>(count)) * std::abs(b);
}

void SetTimes(const std::filesystem::path& file, const Eigen::VectorXd& times, double rate,
              FileTimes use, MarkerTracks* tracks) {
  if (use == FileTimes::kReplaced) {
    bool ascends = times.allFinite();
    for (Eigen::Index i = 1; i < times.size(); ++i) ascends = ascends && times[i] > times[i - 1];
    if (ascends) tracks->times = times;
    return;
  }
  CheckTimes(file, times, rate);
  tracks->times = times;
  WarnOfOtherRate(file, rate, tracks);
}

void NumberRepeatedNames(const std::filesystem::path& file, MarkerTracks* tracks) {
  std::set<std::string> used(tracks->names.begin(), tracks->names.end());
  if (used.size() == tracks->names.size()) return;
  std::map<std::string, int> count;
  std::vector<std::string> repeated;
  for (std::string& name : tracks->names) {
    const std::string own = name;
    int number = ++count[own];
    if (number == 1) continue;
    if (number == 2) repeated.push_back(own);
    while (!used.insert(fmt::format("{} ({})", own, number)).second) ++number;
    name = fmt::format("{} ({})", own, number);
  }
  tracks->warnings.push_back(fmt::format(
      "{}: several markers are called {}; all but the first of them get a number after the "
      "name, such as \"{} (2)\"",
      file.string(), fmt::join(repeated, ", "), repeated.front()));
}

MarkerTracks SelectMarkers(const MarkerTracks& tracks, const std::vector<std::string>& names,
                           const std::filesystem::path& file) {
  std::vector<Eigen::Index> chosen;
  for (const std::string& name : names) {
    const auto found = std::find(tracks.names.begin(), tracks.names.end(), name);
    if (found == tracks.names.end()) {
      throw InputError({file.string()}, fmt::format("has no marker \"{}\"; its markers are {}",
                                                    name, fmt::join(tracks.names, ", ")));
    }
    chosen.push_back(found - tracks.names.begin());
  }
  MarkerTracks selected{names, tracks.times, {}, tracks.length_unit, tracks.warnings};
  for (const Eigen::Matrix3Xd& positions : tracks.positions) {
    selected.positions.push_back(positions(Eigen::all, chosen));
  }
  return selected;
}

}  // namespace lacuna
