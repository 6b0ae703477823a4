// The part of the attached mass that other modules use: a known weight on the object.
#ifndef LACUNA_EFFECTS_ATTACHED_MASS_H_
#define LACUNA_EFFECTS_ATTACHED_MASS_H_

#include <Eigen/Core>
#include <memory>

#include "fem/effect.h"

namespace lacuna {

// A mass (kg) that is distributed around `place` (m, on the undeformed object) as a Gaussian of the
// standard deviation `radius` (m). `gravity`: that of the model, m/s².
std::shared_ptr<const Effect> MakeAttachedMass(double mass, const Eigen::Vector3d& place,
                                               double radius, const Eigen::Vector3d& gravity);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_ATTACHED_MASS_H_
