// With which quantities an error grows, in words.
#ifndef LACUNA_REPORT_ERROR_TREND_TEXT_H_
#define LACUNA_REPORT_ERROR_TREND_TEXT_H_

#include <string>
#include <vector>

#include "record/comparison_record.h"

namespace lacuna {

// Sentences with a leading space: on the clearest trend with a quantity of the motion (or that
// there is none), then on the distance from the grip if that trend is clear.
std::string DescribeTrends(const std::vector<ErrorTrend>& trends);

}  // namespace lacuna

#endif  // LACUNA_REPORT_ERROR_TREND_TEXT_H_
