#include "scan/path_doubts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/median.h"
#include "core/quantity.h"
#include "geometry/rotation.h"
#include "scan/column_name.h"
#include "scan/delimited_table.h"

namespace lacuna {
namespace {

std::string LettersOf(const std::string& column) {
  std::string letters;
  for (const char c : SplitColumnName(column).name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

bool IsQuaternionName(const std::string& column) {
  constexpr std::array kNames{"qx", "qy", "qz", "qw", "q0", "q1", "q2", "q3", "qi", "qj", "qk"};
  const std::string letters = LettersOf(column);
  return letters.find("quat") != std::string::npos ||
         std::find(kNames.begin(), kNames.end(), letters) != kNames.end();
}

bool IsEulerName(const std::string& column) {
  constexpr std::array kNames{"roll", "pitch", "yaw", "euler"};
  const std::string letters = LettersOf(column);
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](const char* name) { return letters.find(name) != std::string::npos; });
}

// Euler angles about several axes are no rotation vector, unless they are small.
bool TurnsAboutSeveralAxes(const Eigen::Matrix3Xd& rotations) {
  constexpr double kSmall = 0.1;  // rad
  const Eigen::Vector3d range = rotations.rowwise().maxCoeff() - rotations.rowwise().minCoeff();
  return (range.array() > kSmall).count() > 1;
}

}  // namespace

std::string DoubtOfTurn(const RecordedGrip& grip) {
  if (!grip.turns_in_radians) return "";
  const std::vector<std::string>& names = grip.turn_columns;
  if (std::any_of(names.begin(), names.end(), IsQuaternionName))
    return fmt::format(
        "its turn is read from the columns {}: the components of a quaternion are not a "
        "rotation vector",
        fmt::join(names, ", "));
  if (std::any_of(names.begin(), names.end(), IsEulerName) && TurnsAboutSeveralAxes(grip.rotations))
    return fmt::format(
        "its turn is read from the columns {}: Euler angles, about several axes one "
        "after the other, are not a rotation vector",
        fmt::join(names, ", "));
  const double turns = RangeOfPath(grip).turn / (2 * std::numbers::pi);
  if (turns <= 1) return "";
  return fmt::format(
      "it turns by {:.2g} full turns; if the columns of the turn are in degrees, write `unit: deg` "
      "beside them",
      turns);
}

std::string DoubtOfGap(const RecordedGrip& grip, double first, double last) {
  constexpr Eigen::Index kFewest = 10;  // rows, of which an interval is usual
  constexpr double kLong = 10, kMoves = 0.05, kFrequent = 0.1;
  const Eigen::Index rows = grip.times.size();
  if (rows < kFewest) return "";
  std::vector<double> intervals;
  for (Eigen::Index k = 1; k < rows; ++k) intervals.push_back(grip.times[k] - grip.times[k - 1]);
  const double usual = Median(intervals);
  const auto is_long = [&](double interval) { return interval > kLong * usual; };
  if (static_cast<double>(std::count_if(intervals.begin(), intervals.end(), is_long)) >
      kFrequent * static_cast<double>(intervals.size()))
    return "";
  const PathRange range = RangeOfPath(grip);
  for (Eigen::Index k = 1; k < rows; ++k) {
    const double interval = grip.times[k] - grip.times[k - 1];
    if (!is_long(interval) || grip.times[k] <= first || grip.times[k - 1] >= last) continue;
    const double shift = (grip.displacements.col(k) - grip.displacements.col(k - 1)).norm();
    const double turn = grip.rotations.cols() == 0
                            ? 0
                            : AngleBetween(grip.rotations.col(k - 1), grip.rotations.col(k));
    if (shift <= kMoves * range.shift && turn <= kMoves * range.turn) continue;
    return fmt::format(
        "it has no row between {} and {}, {:.0f} times the usual interval, and moves meanwhile; "
        "the motion there is interpolated",
        TimeText(grip.times[k - 1]), TimeText(grip.times[k]), interval / usual);
  }
  return "";
}

std::string DoubtOfJump(const RecordedGrip& grip, double size, double last) {
  for (Eigen::Index k = 1; k < grip.times.size() && grip.times[k - 1] < last; ++k) {
    const double step = (grip.displacements.col(k) - grip.displacements.col(k - 1)).norm();
    if (step <= size) continue;
    return fmt::format(
        "it moves by {:.3g} mm from {} to {}, between two rows, while the object is {:.3g} mm "
        "in size; the motion is relative to the first row, which must belong to the undeformed "
        "object",
        1e3 * step, TimeText(grip.times[k - 1]), TimeText(grip.times[k]), 1e3 * size);
  }
  return "";
}

}  // namespace lacuna
