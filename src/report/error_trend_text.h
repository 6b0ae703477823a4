// Sentences about the quantities with which an error grows.
#ifndef LACUNA_REPORT_ERROR_TREND_TEXT_H_
#define LACUNA_REPORT_ERROR_TREND_TEXT_H_

#include <string>
#include <vector>

#include "record/comparison_record.h"

namespace lacuna {

// Sentences with a leading space. The first describes the clearest trend with a quantity of the
// motion, or says that there is none; the second the trend with the distance from the grip, if it
// is clear.
std::string DescribeTrends(const std::vector<ErrorTrend>& trends);

}  // namespace lacuna

#endif  // LACUNA_REPORT_ERROR_TREND_TEXT_H_
