// The range of values that a number in the user's input may have, and the parsing of such numbers.
#ifndef LACUNA_CORE_BOUNDS_H_
#define LACUNA_CORE_BOUNDS_H_

#include <limits>
#include <string>

#include "core/quantity.h"

namespace lacuna {

// The interval [min, max] in SI units. `open_min` and `open_max` exclude the bound itself.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;
  bool open_max = false;

  // Whether `value` lies in the interval; false for NaN.
  bool Contain(double value) const {
    return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
  }
};

// The most frequent bounds: none, (0, ∞) and [0, ∞).
inline constexpr Bounds kAnyValue{};
inline constexpr Bounds kPositive{0, std::numeric_limits<double>::infinity(), true, false};
inline constexpr Bounds kNotNegative{0, std::numeric_limits<double>::infinity(), false, false};

// The bounds as text to be appended to a noun in a message: " > 0", " in [0, 1 m)"; empty for
// kAnyValue. `unit` is appended to every bound except 0.
std::string Describe(const Bounds& bounds, const std::string& unit);

// Parses a quantity (core/quantity.h) and checks its bounds; returns the SI value. Throws
// std::invalid_argument with a message that states the text and what was expected.
double ParseQuantityWithin(const std::string& text, const Dimension& dimension,
                           const Bounds& bounds);

// Parses a whole number from `min` to `max`. Throws std::invalid_argument like ParseQuantityWithin.
int ParseInteger(const std::string& text, int min, int max);

}  // namespace lacuna

#endif  // LACUNA_CORE_BOUNDS_H_
