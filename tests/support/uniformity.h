// Whether numbers are uniformly distributed between 0 and 1: the test of Kolmogorov and Smirnov.
#ifndef LACUNA_TESTS_SUPPORT_UNIFORMITY_H_
#define LACUNA_TESTS_SUPPORT_UNIFORMITY_H_

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna {

// The p-value, with the correction of Stephens (1970) for small samples: accurate to two digits
// from ten numbers on.
inline double UniformityOf(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  const double n = static_cast<double>(numbers.size());
  double largest = 0;
  for (size_t k = 0; k < numbers.size(); ++k)
    largest = std::max({largest, static_cast<double>(k + 1) / n - numbers[k],
                        numbers[k] - static_cast<double>(k) / n});
  const double scaled = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * largest;
  double tail = 0;
  for (int j = 1; j <= 100; ++j)
    tail += (j % 2 == 1 ? 2 : -2) * std::exp(-2 * j * j * scaled * scaled);
  return std::clamp(tail, 0.0, 1.0);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_UNIFORMITY_H_
