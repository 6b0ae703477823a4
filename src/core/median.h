// The median of numbers.
#ifndef LACUNA_CORE_MEDIAN_H_
#define LACUNA_CORE_MEDIAN_H_

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace lacuna {

// The value in the middle of the sorted values, and of an even number the greater of the two there.
// NaN if there are none. No value may be NaN.
inline double Median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace lacuna

#endif  // LACUNA_CORE_MEDIAN_H_
