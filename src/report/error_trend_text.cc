#include "report/error_trend_text.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "report/quantity_text.h"

namespace lacuna {
namespace {

constexpr double kClearRankCorrelation = 0.3;      // larger: fewer, clearer trends are reported
constexpr double kSignificantDeviations = 2.5758;  // of a normal distribution, two-sided p = 0.01

// The name of a quantity, the unit in which it is printed, and the factor from the SI unit to it.
struct QuantityName {
  std::string name, unit;
  double scale;
};

QuantityName NameOf(const std::string& quantity) {
  static const std::map<std::string, QuantityName> names{
      {"time_s", {"time", "s", 1}},
      {"displacement_m", {"displacement", "mm", 1e3}},
      {"speed_m_per_s", {"speed", "mm/s", 1e3}},
      {"strain", {"strain", "%", 100}},
      {"strain_rate_per_s", {"strain rate", "%/s", 100}},
      {"height_m", {"height", "mm", 1e3}},
      {"grip_distance_m", {"distance from the grip", "mm", 1e3}}};
  const auto found = names.find(quantity);
  return found != names.end() ? found->second : QuantityName{quantity, "", 1};
}

// Whether independent ranks of so many values would give a correlation as large in fewer than one
// of a hundred cases. It is taken as normal with variance 1/(n − 1) (Kendall, Rank Correlation
// Methods, Griffin 1948), which for fewer than about ten values asks for more than the exact
// distribution: fewer than eight are never significant.
bool IsSignificant(double rank_correlation, int count) {
  return std::abs(rank_correlation) * std::sqrt(count - 1.0) >= kSignificantDeviations;
}

// Whether the rank correlation is clear, significant and has the sign of the change of the error
// from the first to the last bin.
bool IsClear(const ErrorTrend& trend) {
  if (!(std::abs(trend.rank_correlation) >= kClearRankCorrelation) || trend.bins.size() < 2)
    return false;
  int count = 0;
  for (const ErrorBin& bin : trend.bins) count += bin.count;
  if (!IsSignificant(trend.rank_correlation, count)) return false;
  const double change = trend.bins.back().rms - trend.bins.front().rms;
  return change * trend.rank_correlation > 0;
}

// "It grows with speed (rank correlation 0.60), from 0.100 mm at 2 mm/s to 0.400 mm at 80 mm/s."
std::string DescribeTrend(const ErrorTrend& trend) {
  const QuantityName quantity = NameOf(trend.quantity);
  const auto value = [&](const ErrorBin& bin) {
    return fmt::format("{} at {:.3g} {}", Millimetres(bin.rms), quantity.scale * bin.mean,
                       quantity.unit);
  };
  return fmt::format(" The error {} with {} (rank correlation {:.2f}), from {} to {}.",
                     trend.rank_correlation > 0 ? "grows" : "decreases", quantity.name,
                     trend.rank_correlation, value(trend.bins.front()), value(trend.bins.back()));
}

}  // namespace

std::string DescribeTrends(const std::vector<ErrorTrend>& trends) {
  const ErrorTrend *in_motion = nullptr, *along_object = nullptr;
  for (const ErrorTrend& trend : trends) {
    if (!IsClear(trend)) continue;
    if (trend.quantity == "grip_distance_m") {
      along_object = &trend;
    } else if (in_motion == nullptr ||
               std::abs(trend.rank_correlation) > std::abs(in_motion->rank_correlation)) {
      in_motion = &trend;
    }
  }
  std::string text = in_motion != nullptr
                         ? DescribeTrend(*in_motion)
                         : " The error shows no clear trend with any quantity of the motion.";
  if (along_object != nullptr) text += DescribeTrend(*along_object);
  return text;
}

}  // namespace lacuna
