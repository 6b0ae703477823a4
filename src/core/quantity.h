// Parsing of physical quantities as users write them: "0.1 MPa", "30 mm", "12 Pa s", "9.81 m/s^2".
//
// Lacuna computes in SI units throughout; other units exist only in the input files.
#ifndef LACUNA_CORE_QUANTITY_H_
#define LACUNA_CORE_QUANTITY_H_

#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// The exponents of the base units, with strings for error messages and output. The strings must
// have static storage duration.
struct Dimension {
  int metre = 0, kilogram = 0, second = 0, kelvin = 0, radian = 0;
  const char* name = "a plain number";  // e.g. "a density"
  const char* example = "0.5";          // e.g. "1070 kg/m^3"
  const char* unit = "";                // SI unit for output, e.g. "kg/m^3"

  bool SameAs(const Dimension& other) const {
    return metre == other.metre && kilogram == other.kilogram && second == other.second &&
           kelvin == other.kelvin && radian == other.radian;
  }
};

inline constexpr Dimension kDimensionless{};
inline constexpr Dimension kLength{1, 0, 0, 0, 0, "a length", "30 mm", "m"};
inline constexpr Dimension kArea{2, 0, 0, 0, 0, "an area", "4 mm^2", "m^2"};
inline constexpr Dimension kVolume{3, 0, 0, 0, 0, "a volume", "8 mm^3", "m^3"};
inline constexpr Dimension kTime{0, 0, 1, 0, 0, "a time", "10 ms", "s"};
inline constexpr Dimension kRate{0, 0, -1, 0, 0, "a rate", "30 Hz", "1/s"};
inline constexpr Dimension kVelocity{1, 0, -1, 0, 0, "a velocity", "0.2 m/s", "m/s"};
inline constexpr Dimension kAcceleration{1, 0, -2, 0, 0, "an acceleration", "9.81 m/s^2", "m/s^2"};
inline constexpr Dimension kMass{0, 1, 0, 0, 0, "a mass", "52 g", "kg"};
inline constexpr Dimension kDensity{-3, 1, 0, 0, 0, "a density", "1070 kg/m^3", "kg/m^3"};
inline constexpr Dimension kForce{1, 1, -2, 0, 0, "a force", "0.5 N", "N"};
inline constexpr Dimension kPressure{-1, 1, -2, 0, 0, "a pressure", "0.1 MPa", "Pa"};
inline constexpr Dimension kViscosity{-1, 1, -1, 0, 0, "a viscosity", "12 Pa s", "Pa s"};
inline constexpr Dimension kStiffness{0, 1, -2, 0, 0, "a stiffness", "200 N/m", "N/m"};
inline constexpr Dimension kTemperature{0, 0, 0, 1, 0, "a temperature", "20 K", "K"};
inline constexpr Dimension kAngle{0, 0, 0, 0, 1, "an angle", "30 deg", "rad"};

// Returns the SI value of `text`, a number with a unit. Products of units are written with a space,
// '*', '·' or '.', quotients with '/' and powers with '^'. A number without a unit is accepted only
// for a dimensionless quantity, and 0 for any, because it is the same in every unit. Throws
// std::invalid_argument with a message that states what was expected if `text` is not a finite
// number, or if its unit is unknown or has another dimension. The message about a decimal comma, as
// in "0,2 mm", says how to write the number.
double ParseQuantity(std::string_view text, const Dimension& expected);

// What to say of a number with a decimal comma; `meant` is the number with a point, "0.2 mm".
std::string DecimalCommaText(const std::string& meant);

// A quantity with the dimension of its own unit, e.g. "3 N/kg"; dimensionless without a unit.
struct MeasuredQuantity {
  double value = 0;  // SI
  Dimension dimension;
};
// Throws std::invalid_argument for text that is not a number or has an unknown unit.
MeasuredQuantity ParseAnyQuantity(std::string_view text);

// The symbols of units of this dimension, with their prefixes, that differ from `symbol` in the
// case of their letters at most: kN for "KN", mN and MN for "mn".
std::vector<std::string> UnitsInAnyCase(std::string_view symbol, const Dimension& dimension);

// A length of time in s to three digits, as "2.5 ms" or, from one second on, "1.5 s".
std::string DurationText(double seconds);

// A point in time in s, to six digits or, from 1000 s on, where the origin may be that of a
// calendar, to a millisecond: "0.25 s", "1700000000.25 s".
std::string TimeText(double seconds);

}  // namespace lacuna

#endif  // LACUNA_CORE_QUANTITY_H_
