// Vectors among an effect's parameters: three of them, named `axis_x`, `axis_y`, `axis_z`, that
// users write as one, `axis: [0, 0, 1]`.
#ifndef LACUNA_EFFECTS_VECTOR_PARAMETERS_H_
#define LACUNA_EFFECTS_VECTOR_PARAMETERS_H_

#include <Eigen/Core>
#include <string>

#include "effects/catalogue.h"

namespace lacuna {

// Adds `common`'s name with _x, _y and _z, and its meaning with " along x" and so on. A default
// with NaN: the user must give it.
void AppendVector(const ParameterCard& common, const Eigen::Vector3d& default_value,
                  EffectCard* card);

// "axis" where the parameters axis_x, axis_y, axis_z begin, else "".
std::string VectorNameAt(const EffectCard& card, size_t k);

// `centre`, a place on the body at rest, "where the mass sits", and the setting `radius`, how far
// the effect is spread about it.
void AppendPlace(const std::string& meaning, EffectCard* card);

// `gravity` as a setting: the acceleration of free fall, by default 9.80665 m/s² down z.
void AppendGravitySetting(EffectCard* card);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_VECTOR_PARAMETERS_H_
