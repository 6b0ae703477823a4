// Effects as the YAML that describes them.
#ifndef LACUNA_EFFECTS_EFFECT_TEXT_H_
#define LACUNA_EFFECTS_EFFECT_TEXT_H_

#include <optional>
#include <string>

#include "fem/effect.h"

namespace lacuna {

// A flow mapping that MakeEffect(Config), or MakeMaterial for an elasticity law, reads back to the
// same type and, to the last bit, the same parameters:
//   {type: gravity, acceleration: [0 m/s^2, 0 m/s^2, -9.80665 m/s^2]}
// SI units, numbers in their shortest form. What YAML cannot say, an infinite value or a direction
// of length 0, is left out where it is the default. Parameters must be within the card's bounds, or
// they are refused when they are read.
//
// Nothing for an effect that is not the catalogue's (a measured force) or one with such a value
// that is not the default.
std::optional<std::string> FormatEffect(const Effect& effect);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EFFECT_TEXT_H_
