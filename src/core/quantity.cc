#include "core/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "core/letter_case.h"

namespace lacuna {
namespace {

struct Unit {
  std::string_view symbol;
  double si;
  Dimension dimension;
};

// The symbols that may have an SI prefix. The list therefore contains "g" and not "kg".
constexpr std::array kPrefixable = {
    Unit{"m", 1, kLength},          Unit{"g", 1e-3, kMass},   Unit{"s", 1, kTime},
    Unit{"N", 1, kForce},           Unit{"Pa", 1, kPressure}, Unit{"Hz", 1, kRate},
    Unit{"K", 1, kTemperature},     Unit{"rad", 1, kAngle},   Unit{"J", 1, {2, 1, -2, 0, 0}},
    Unit{"W", 1, {2, 1, -3, 0, 0}}, Unit{"l", 1e-3, kVolume}, Unit{"bar", 1e5, kPressure},
    Unit{"gf", 9.80665e-3, kForce}, Unit{"sec", 1, kTime},    Unit{"Nm", 1, {2, 1, -2, 0, 0}},
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
    Unit{"kp", 9.80665, kForce},
    Unit{"dyn", 1e-5, kForce},
    Unit{"lbf", 4.4482216152605, kForce},
    Unit{"lb", 0.45359237, kMass},
    Unit{"lbs", 0.45359237, kMass},
    Unit{"Nmm", 1e-3, {2, 1, -2, 0, 0}},
    Unit{"1", 1, kDimensionless},
};
struct Prefix {
  std::string_view symbol;
  double factor;
};
constexpr std::array kPrefixes = {
    Prefix{"n", 1e-9}, Prefix{"u", 1e-6}, Prefix{"µ", 1e-6}, Prefix{"μ", 1e-6},
    Prefix{"m", 1e-3}, Prefix{"c", 1e-2}, Prefix{"d", 1e-1}, Prefix{"da", 10},
    Prefix{"k", 1e3},  Prefix{"M", 1e6},  Prefix{"G", 1e9},
};

const Unit* FindSymbol(std::string_view symbol, bool prefixable_only) {
  for (const Unit& unit : kPrefixable)
    if (unit.symbol == symbol) return &unit;
  if (prefixable_only) return nullptr;
  for (const Unit& unit : kUnprefixed)
    if (unit.symbol == symbol) return &unit;
  return nullptr;
}

// A whole symbol takes precedence over a prefixed one, so that "min" is a minute.
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

// Reads a product of units such as "kg/m^3" or "Pa s" factor by factor.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : rest_(text) {}

  Unit Read() {
    Unit product{"", 1, kDimensionless};
    int sign = 1;
    std::string_view before;  // the operator before the next unit
    for (SkipSpace(); !rest_.empty(); SkipSpace()) {
      std::string_view found;
      for (const std::string_view operation : {"/", "*", "·", "."})
        if (found.empty() && Take(operation)) found = operation;
      if (!found.empty()) {
        RequireNoOperator(before);
        before = found;
        if (found == "/") sign = -1;
        continue;
      }
      before = "";
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
    RequireNoOperator(before);
    return product;
  }

 private:
  static void RequireNoOperator(std::string_view before) {
    if (!before.empty())
      throw std::invalid_argument(fmt::format("a unit must follow \"{}\"", before));
  }
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
      if (std::isspace(static_cast<unsigned char>(c)) || c == '/' || c == '*' || c == '.' ||
          c == '^' || tail.starts_with("·") || tail.starts_with("²") || tail.starts_with("³") ||
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

// Returns the number at the beginning of `text`, and in `*rest` the text after it.
double ReadNumber(std::string_view text, std::string_view* rest) {
  double number = 0;
  const char* begin = text.data();
  if (text.starts_with("+-")) throw std::invalid_argument("");
  if (text.starts_with('+')) ++begin;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
  if (error != std::errc()) throw std::invalid_argument("");
  if (!std::isfinite(number)) throw std::invalid_argument("not a finite number");
  *rest = Trim(text.substr(end - text.data()));
  return number;
}

// Returns the number at the beginning of `text` with the unit after it, and in `*unit_text` the
// text of the unit.
std::pair<double, Unit> ReadNumberAndUnit(std::string_view text, std::string_view* unit_text) {
  const double number = ReadNumber(text, unit_text);
  return {number, UnitReader(*unit_text).Read()};
}

// Throws std::invalid_argument where the number has a decimal comma, and a point in its place would
// make `text` a quantity: not in "1,234.5 mm".
void RefuseDecimalComma(std::string_view text) {
  const size_t comma = text.find_first_not_of("+-0123456789");
  if (comma == std::string_view::npos || text[comma] != ',') return;
  if (comma + 1 == text.size() || std::isdigit(static_cast<unsigned char>(text[comma + 1])) == 0)
    return;
  std::string meant(text);
  meant[comma] = '.';
  try {
    std::string_view unit_text;
    ReadNumberAndUnit(meant, &unit_text);
  } catch (const std::invalid_argument&) {
    return;
  }
  throw std::invalid_argument(DecimalCommaText(meant));
}

// Returns a pointer to a copy of `text` that exists until the program ends, since a Dimension does
// not own its strings.
const char* KeptText(const std::string& text) {
  static std::mutex mutex;
  static std::set<std::string> kept;
  const std::lock_guard lock(mutex);
  return kept.insert(text).first->c_str();
}

// The SI unit of a dimension, for example "kg m/s^2".
std::string UnitText(const Dimension& dimension) {
  std::string above, below;
  const std::pair<const char*, int> factors[] = {{"kg", dimension.kilogram},
                                                 {"m", dimension.metre},
                                                 {"s", dimension.second},
                                                 {"K", dimension.kelvin},
                                                 {"rad", dimension.radian}};
  for (const auto& [symbol, power] : factors) {
    if (power == 0) continue;
    if (power > 0 && !above.empty()) above += " ";
    (power > 0 ? above : below) += (power > 0 ? "" : "/") + std::string(symbol) +
                                   (std::abs(power) > 1 ? fmt::format("^{}", std::abs(power)) : "");
  }
  return (above.empty() ? "1" : above) + below;
}

// The dimension with its strings: those of a named dimension if there is one with these exponents,
// otherwise strings that are made from the unit.
Dimension InWords(const Dimension& dimension) {
  for (const Dimension& known :
       {kDimensionless, kLength, kArea, kVolume, kTime, kRate, kVelocity, kAcceleration, kMass,
        kDensity, kForce, kPressure, kViscosity, kStiffness, kTemperature, kAngle}) {
    if (known.SameAs(dimension)) return known;
  }
  Dimension named = dimension;
  named.unit = KeptText(UnitText(dimension));
  named.name = KeptText(fmt::format("a quantity in {}", named.unit));
  named.example = KeptText(fmt::format("0.5 {}", named.unit));
  return named;
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
  std::string_view unit_text;
  Unit unit{"", 1, kDimensionless};
  try {
    RefuseDecimalComma(trimmed);
    std::tie(number, unit) = ReadNumberAndUnit(trimmed, &unit_text);
  } catch (const std::invalid_argument& problem) {
    refuse(problem.what());
  }
  if (unit_text.empty() && number == 0) return 0;
  if (unit_text.empty() && !expected.SameAs(kDimensionless)) refuse("a unit is missing");
  if (!unit.dimension.SameAs(expected)) refuse("its unit has another dimension");
  return number * unit.si;
}

std::string DecimalCommaText(const std::string& meant) {
  return fmt::format("the decimal separator must be a point: \"{}\"", meant);
}

MeasuredQuantity ParseAnyQuantity(std::string_view text) {
  const std::string_view trimmed = Trim(text);
  try {
    RefuseDecimalComma(trimmed);
    std::string_view unit_text;
    const auto [number, unit] = ReadNumberAndUnit(trimmed, &unit_text);
    return {number * unit.si, InWords(unit.dimension)};
  } catch (const std::invalid_argument& problem) {
    const std::string why = problem.what();
    throw std::invalid_argument(
        fmt::format("got \"{}\"{}; expected a number with its unit, e.g. \"3 N/kg\"", trimmed,
                    why.empty() ? "" : " (" + why + ")"));
  }
}

std::vector<std::string> UnitsInAnyCase(std::string_view symbol, const Dimension& dimension) {
  std::vector<std::string> found;
  const std::string wanted = InLowerCase(symbol);
  const auto add = [&](const Unit& unit, std::string_view prefix) {
    const std::string whole = std::string(prefix) + std::string(unit.symbol);
    if (unit.dimension.SameAs(dimension) && InLowerCase(whole) == wanted) found.push_back(whole);
  };
  for (const Unit& unit : kUnprefixed) add(unit, "");
  for (const Unit& unit : kPrefixable) {
    add(unit, "");
    for (const Prefix& prefix : kPrefixes) add(unit, prefix.symbol);
  }
  return found;
}

std::string DurationText(double seconds) {
  return seconds < 1 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

std::string TimeText(double seconds) {
  constexpr double kLong = 1000;
  if (std::abs(seconds) < kLong) return fmt::format("{:g} s", seconds);
  return fmt::format("{:.15g} s", std::round(1e3 * seconds) / 1e3);
}

}  // namespace lacuna
