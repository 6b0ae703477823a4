#include "core/bounds.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/parsed_word.h"

namespace lacuna {

std::string Describe(const Bounds& bounds, const std::string& unit) {
  const auto number = [&](double value) {
    return unit.empty() || value == 0 ? fmt::format("{:g}", value)
                                      : fmt::format("{:g} {}", value, unit);
  };
  if (std::isfinite(bounds.min) && std::isfinite(bounds.max)) {
    return fmt::format(" in {}{}, {}{}", bounds.open_min ? "(" : "[", number(bounds.min),
                       number(bounds.max), bounds.open_max ? ")" : "]");
  }
  if (std::isfinite(bounds.min))
    return fmt::format(" {} {}", bounds.open_min ? ">" : "≥", number(bounds.min));
  if (std::isfinite(bounds.max))
    return fmt::format(" {} {}", bounds.open_max ? "<" : "≤", number(bounds.max));
  return "";
}

double ParseQuantityWithin(const std::string& text, const Dimension& dimension,
                           const Bounds& bounds) {
  const double value = ParseQuantity(text, dimension);
  if (!bounds.Contain(value)) {
    throw std::invalid_argument(fmt::format("got \"{}\"; expected {}{}", text, dimension.name,
                                            Describe(bounds, dimension.unit)));
  }
  return value;
}

int ParseInteger(const std::string& text, int min, int max) {
  const std::string expected = max == std::numeric_limits<int>::max()
                                   ? fmt::format("a whole number ≥ {}", min)
                                   : fmt::format("a whole number from {} to {}", min, max);
  const auto value = ParseSignedWord<int>(text);
  if (!value || *value < min || *value > max)
    throw std::invalid_argument(fmt::format("got \"{}\"; expected {}", text, expected));
  return *value;
}

}  // namespace lacuna
