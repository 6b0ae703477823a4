#include "report/quantity_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lacuna {

std::string Millimetres(double length) {
  if (std::isnan(length)) return "an unknown length";
  const double mm = 1e3 * length;
  return mm < 0.1 ? fmt::format("{:.2g} mm", mm) : fmt::format("{:.3f} mm", mm);
}

std::string ProbabilityText(double p_value) {
  return p_value <= 0.001 ? "p ≤ 0.001" : fmt::format("p = {:.2g}", p_value);
}

std::string PercentText(double probability) {
  if (probability > 0.995) return "> 99 %";
  if (probability < 0.005) return "< 1 %";
  return fmt::format("{:.0f} %", 100 * probability);
}

std::string WithUnit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string DirectionText(const Eigen::Vector3d& vector) {
  constexpr double kCosineOf30Degrees = 0.866;
  const Eigen::Vector3d unit = vector.normalized();
  int axes[] = {0, 1, 2};
  std::sort(std::begin(axes), std::end(axes),
            [&](int a, int b) { return std::abs(unit[a]) > std::abs(unit[b]); });
  const auto name = [&](int axis) {
    return fmt::format("{}{}", unit[axis] < 0 ? "−" : "+", "xyz"[axis]);
  };
  std::string text = name(axes[0]);
  if (std::abs(unit[axes[0]]) < kCosineOf30Degrees) text += " and " + name(axes[1]);
  return text;
}

std::string EnumerationText(const std::vector<std::string>& phrases) {
  if (phrases.empty()) return "";
  if (phrases.size() == 1) return phrases.front();
  return fmt::format("{} and {}", fmt::join(phrases.begin(), phrases.end() - 1, ", "),
                     phrases.back());
}

}  // namespace lacuna
