// Writes effects as the YAML mappings that describe them.
#ifndef LACUNA_EFFECTS_EFFECT_TEXT_H_
#define LACUNA_EFFECTS_EFFECT_TEXT_H_

#include <optional>
#include <string>

#include "fem/effect.h"

namespace lacuna {

// A value in SI units with its unit, in the shortest form that reads back to the same bits:
// "-9.80665 m/s^2".
std::string FormatQuantity(double value, const Dimension& dimension);

// A flow mapping from which MakeEffect(Config), or MakeMaterial for an elasticity law, makes an
// effect of the same type with bit-identical parameter values:
//   {type: gravity, acceleration: [0 m/s^2, 0 m/s^2, -9.80665 m/s^2]}
// Values are in SI units and in their shortest form. A value that YAML cannot express (infinity, a
// direction of length 0) is omitted if it is the default. Values outside the bounds of the card are
// written, but refused when they are read.
//
// Returns nothing for an effect that is not in the catalogue (a measured force), and for an effect
// with an inexpressible value that is not the default.
std::optional<std::string> FormatEffect(const Effect& effect);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EFFECT_TEXT_H_
