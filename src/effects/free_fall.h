// The acceleration of free fall: its standard value, and the setting of effects that add mass.
#ifndef LACUNA_EFFECTS_FREE_FALL_H_
#define LACUNA_EFFECTS_FREE_FALL_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "fem/effect.h"

namespace lacuna {

inline constexpr double kStandardGravity = 9.80665;  // m/s², 3rd CGPM, 1901

// The setting `gravity` of effects that add mass to the body: the acceleration of free fall of that
// mass, m/s². It is that of the model's gravity, or 0 where the weight of the mass is given in
// another way. The reader of effects takes it from the model if it is omitted and refuses another
// value; in a model without gravity it must be given (ReadParameters in effects/catalogue.h).
inline constexpr char kGravitySetting[] = "gravity";

// The potential energy of the weight of nodal masses (n, kg), J: −Σ m_i g·(x_i − X_i), which is 0
// at the rest shape, so that small differences are not lost to rounding. `gravity`: g, m/s².
double WeightEnergy(const Kinematics& at, const Eigen::VectorXd& mass,
                    const Eigen::Vector3d& gravity);

// Whether two accelerations of free fall are the same but for the rounding of their units.
bool IsSameGravity(const Eigen::Vector3d& one, const Eigen::Vector3d& other);

// Appends the setting, without a default value.
void AppendGravitySetting(EffectCard* card);

// The index of the first of its three components; −1 on a card without it.
int GravitySettingOn(const EffectCard& card);
// The setting of an effect, m/s²; nothing for an effect without it.
std::optional<Eigen::Vector3d> GravitySettingOf(const Effect& effect);
// The effect with this value of the setting, m/s²; the same effect if it has none.
std::shared_ptr<const Effect> WithGravitySetting(const std::shared_ptr<const Effect>& effect,
                                                 const Eigen::Vector3d& gravity);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_FREE_FALL_H_
