// Vectors among the parameters of an effect, and the parameters that several effects share.
//
// A card holds a vector as three consecutive parameters, `axis_x`, `axis_y` and `axis_z`; users
// write it as one key, `axis: [0, 0, 1]`. The functions append to `card->parameters`; their order
// is the order in which the effect receives its values. A default value of NaN means that the user
// must give the vector.
#ifndef LACUNA_EFFECTS_VECTOR_PARAMETERS_H_
#define LACUNA_EFFECTS_VECTOR_PARAMETERS_H_

#include <Eigen/Core>
#include <string>

#include "record/effect_card.h"

namespace lacuna {

// Appends the three components of a vector. `common` describes each of them: its name is completed
// with _x, _y, _z and its meaning with " along x", " along y", " along z".
void AppendVector(const ParameterCard& common, const Eigen::Vector3d& default_value,
                  EffectCard* card);

// Appends a direction of any length: dimensionless, a setting, without a null value.
void AppendDirectionSetting(const std::string& name, const std::string& meaning,
                            const Eigen::Vector3d& default_value, EffectCard* card);

// Appends a point of the body at rest, m: a setting, without a null value, by default the origin.
void AppendPointSetting(const std::string& name, const std::string& meaning, EffectCard* card);

// "axis" if the parameters axis_x, axis_y, axis_z begin at index k of the card, else "".
std::string VectorNameAt(const EffectCard& card, size_t k);

// Appends `centre` (m), the place on the body at rest where the effect acts, which must be given,
// and the setting `radius` (m), the standard deviation of its spread about that place. `meaning`
// describes the place, e.g. "place of the mass on the body at rest".
void AppendPlace(const std::string& meaning, EffectCard* card);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_VECTOR_PARAMETERS_H_
