#include "scan/time_span.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/quantity.h"
#include "scan/time_series.h"

namespace lacuna {
namespace {

// How often a change of the unit makes times smaller (> 1) or larger, and what it says.
struct UnitMistake {
  double factor;
  const char* what;
};
constexpr std::array kMistakes{
    UnitMistake{1e3, "divided by 1000 (milliseconds, not seconds?)"},
    UnitMistake{1e6, "divided by 1000000 (microseconds, not seconds?)"},
    UnitMistake{1e-3, "multiplied by 1000 (seconds, not milliseconds?)"},
    UnitMistake{1e-6, "multiplied by 1000000 (seconds, not microseconds?)"},
    UnitMistake{1 / 60.0, "multiplied by 60 (minutes, not seconds?)"},
    UnitMistake{60, "divided by 60 (seconds, not minutes?)"}};

// The change of unit after which the series ends near the end of the recording; null if none does.
const UnitMistake* LikelyMistake(double end, double last) {
  constexpr double kNear = 1.6;  // the series may end somewhat before or after the recording
  for (const UnitMistake& mistake : kMistakes) {
    const double ratio = end / mistake.factor / last;
    if (ratio > 1 / kNear && ratio < kNear) return &mistake;
  }
  return nullptr;
}

double Range(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  return (values.rowwise().maxCoeff() - values.rowwise().minCoeff()).maxCoeff();
}

// The values within the recording, those at its ends included.
Eigen::MatrixXd Within(const Eigen::VectorXd& times,
                       const Eigen::Ref<const Eigen::MatrixXd>& values, double first, double last) {
  Eigen::MatrixXd within(values.rows(), values.cols() + 2);
  Eigen::Index count = 0;
  for (const double end : {first, last})
    within.col(count++) = InterpolateLinearly(times, values, end);
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    if (times[i] > first && times[i] < last) within.col(count++) = values.col(i);
  }
  return within.leftCols(count);
}

}  // namespace

double TimeMargin(const std::vector<double>& frame_times) {
  constexpr double kShareOfInterval = 1e-3;
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const double first = frame_times.front(), last = frame_times.back();
  const double rounding = kRounding * std::max(std::abs(first), std::abs(last));
  if (frame_times.size() < 2) return rounding;
  const double interval = (last - first) / static_cast<double>(frame_times.size() - 1);
  return std::max(kShareOfInterval * interval, rounding);
}

bool CoversTimes(const Eigen::VectorXd& times, double first, double last, double margin) {
  constexpr double kRounding = 1e-9;
  const double begin = times[0], end = times[times.size() - 1];
  const double allowed = std::max(margin, kRounding * (end - begin));
  return first >= begin - allowed && last <= end + allowed;
}

std::string DoubtOfTimeSpan(const Eigen::VectorXd& times,
                            const Eigen::Ref<const Eigen::MatrixXd>& values, double first,
                            double last) {
  const double duration = last - first;
  if (times.size() < 2 || !(duration > 0)) return "";
  const double begin = times[0], end = times[times.size() - 1];
  const UnitMistake* mistake = LikelyMistake(end, last);
  const bool is_long = end > last + 4 * duration;
  const bool goes_on = end > last || begin < first;
  const double range = Range(values), within = Range(Within(times, values, first, last));
  const bool is_still = goes_on && within < 0.05 * range;
  const bool is_short = end - begin < 0.01 * duration && mistake != nullptr;
  if (!is_long && !is_still && !is_short) return "";
  std::string text = fmt::format("its times are {} to {}, those of the recording {} to {}",
                                 TimeText(begin), TimeText(end), TimeText(first), TimeText(last));
  if (is_still)
    text += fmt::format(", in which it changes by {:.2g} % of its range", 100 * within / range);
  if (mistake != nullptr) return text + fmt::format("; they would fit {}", mistake->what);
  return text + "; check their unit and their origin";
}

}  // namespace lacuna
