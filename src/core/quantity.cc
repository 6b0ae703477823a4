#include "core/quantity.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace lacuna {
namespace {

struct Unit {
  std::string_view symbol;
  double si;
  Dimension dimension;
};

// Symbols that may carry an SI prefix. "g" stands here, not "kg": the prefix makes the rest.
constexpr std::array kPrefixable = {
    Unit{"m", 1, kLength},          Unit{"g", 1e-3, kMass},   Unit{"s", 1, kTime},
    Unit{"N", 1, kForce},           Unit{"Pa", 1, kPressure}, Unit{"Hz", 1, kRate},
    Unit{"K", 1, kTemperature},     Unit{"rad", 1, kAngle},   Unit{"J", 1, {2, 1, -2, 0, 0}},
    Unit{"W", 1, {2, 1, -3, 0, 0}}, Unit{"l", 1e-3, kVolume}, Unit{"bar", 1e5, kPressure},
};
constexpr std::array kUnprefixed = {
    Unit{"deg", std::numbers::pi / 180, kAngle},
    Unit{"°", std::numbers::pi / 180, kAngle},
    Unit{"min", 60, kTime},
    Unit{"h", 3600, kTime},
    Unit{"in", 0.0254, kLength},
    Unit{"%", 0.01, kDimensionless},
    Unit{"t", 1e3, kMass},
    Unit{"psi", 6894.757293168361, kPressure},
    Unit{"1", 1, kDimensionless},
};
struct Prefix {
  std::string_view symbol;
  double factor;
};
constexpr std::array kPrefixes = {
    Prefix{"n", 1e-9}, Prefix{"u", 1e-6}, Prefix{"µ", 1e-6}, Prefix{"μ", 1e-6}, Prefix{"m", 1e-3},
    Prefix{"c", 1e-2}, Prefix{"d", 1e-1}, Prefix{"k", 1e3},  Prefix{"M", 1e6},  Prefix{"G", 1e9},
};

const Unit* FindSymbol(std::string_view symbol, bool prefixable_only) {
  for (const Unit& unit : kPrefixable)
    if (unit.symbol == symbol) return &unit;
  if (prefixable_only) return nullptr;
  for (const Unit& unit : kUnprefixed)
    if (unit.symbol == symbol) return &unit;
  return nullptr;
}

// Whole symbols win over prefixed ones, so that "min" is a minute and "m" a metre.
Unit LookUp(std::string_view symbol) {
  if (const Unit* unit = FindSymbol(symbol, false)) return *unit;
  for (const Prefix& prefix : kPrefixes) {
    if (!symbol.starts_with(prefix.symbol)) continue;
    if (const Unit* unit = FindSymbol(symbol.substr(prefix.symbol.size()), true)) {
      return {symbol, prefix.factor * unit->si, unit->dimension};
    }
  }
  throw std::invalid_argument(fmt::format("unknown unit \"{}\"", symbol));
}

// A unit product such as "kg/m^3" or "Pa s", read factor by factor.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : rest_(text) {}

  Unit Read() {
    Unit product{"", 1, kDimensionless};
    int sign = 1;
    for (SkipSpace(); !rest_.empty(); SkipSpace()) {
      if (Take("/")) {
        sign = -1;
        continue;
      }
      if (Take("*") || Take("·")) continue;
      const Unit unit = LookUp(ReadSymbol());
      const int power = sign * ReadPower();
      product.si *= std::pow(unit.si, power);
      product.dimension.metre += power * unit.dimension.metre;
      product.dimension.kilogram += power * unit.dimension.kilogram;
      product.dimension.second += power * unit.dimension.second;
      product.dimension.kelvin += power * unit.dimension.kelvin;
      product.dimension.radian += power * unit.dimension.radian;
      sign = 1;
    }
    if (sign < 0) throw std::invalid_argument("a unit must follow \"/\"");
    return product;
  }

 private:
  void SkipSpace() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())))
      rest_.remove_prefix(1);
  }
  bool Take(std::string_view token) {
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }
  std::string_view ReadSymbol() {
    size_t end = 0;
    while (end < rest_.size()) {
      const std::string_view tail = rest_.substr(end);
      const char c = tail.front();
      if (std::isspace(static_cast<unsigned char>(c)) || c == '/' || c == '*' || c == '^' ||
          tail.starts_with("·") || tail.starts_with("²") || tail.starts_with("³") ||
          (end > 0 && (std::isdigit(static_cast<unsigned char>(c)) || c == '-'))) {
        break;
      }
      ++end;
    }
    const std::string_view symbol = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return symbol;
  }
  int ReadPower() {
    if (Take("²")) return 2;
    if (Take("³")) return 3;
    const bool caret = Take("^");
    int power = 1;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), power);
    if (error != std::errc()) {
      if (caret) throw std::invalid_argument("a whole number must follow \"^\"");
      return 1;
    }
    rest_.remove_prefix(end - rest_.data());
    return power;
  }

  std::string_view rest_;
};

std::string_view Trim(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
    text.remove_suffix(1);
  return text;
}

}  // namespace

double ParseQuantity(std::string_view text, const Dimension& expected) {
  const std::string_view trimmed = Trim(text);
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("got \"{}\"{}; expected {}, e.g. \"{}\"", trimmed,
                                            why.empty() ? "" : " (" + why + ")", expected.name,
                                            expected.example));
  };
  double number = 0;
  const char* begin = trimmed.data();
  if (trimmed.starts_with('+')) ++begin;
  const auto [end, error] = std::from_chars(begin, trimmed.data() + trimmed.size(), number);
  if (error != std::errc()) refuse("");
  if (!std::isfinite(number)) refuse("not a finite number");

  const std::string_view unit_text = Trim(trimmed.substr(end - trimmed.data()));
  if (unit_text.empty()) {
    if (!expected.SameAs(kDimensionless)) refuse("a unit is missing");
    return number;
  }
  try {
    const Unit unit = UnitReader(unit_text).Read();
    if (!unit.dimension.SameAs(expected)) refuse("its unit measures something else");
    return number * unit.si;
  } catch (const std::invalid_argument& problem) {
    if (std::string_view(problem.what()).starts_with("got ")) throw;
    refuse(problem.what());
  }
  return 0;  // not reached: refuse() throws
}

}  // namespace lacuna
