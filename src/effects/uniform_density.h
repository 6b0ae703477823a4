// The density of the body as a parameter of a fit.
//
//   f_i = (ρ − ρ₀) V_i (g − a_i)   (I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687),
// with the density ρ₀ with which the body was made, its nodal volumes V_i and the acceleration of
// free fall g. At ρ = ρ₀ the force vanishes; at any other ρ the inertia and the weight are those of
// a body of density ρ. Mass-proportional damping stays that of ρ₀.
//
// The effect is not in the catalogue, because a body always has a density: experiments state its
// uncertainty under `density_deviation`, and no diagnosis tries the effect.
#ifndef LACUNA_EFFECTS_UNIFORM_DENSITY_H_
#define LACUNA_EFFECTS_UNIFORM_DENSITY_H_

#include <Eigen/Core>
#include <memory>

#include "fem/model.h"

namespace lacuna {

// `density`: ρ, kg/m³, > 0; `gravity`: g, m/s², zero in a model without gravity. The density is
// parameter 0.
std::shared_ptr<const Effect> MakeUniformDensity(double density, const Eigen::Vector3d& gravity);

bool IsUniformDensity(const Effect& effect);

// The density, kg/m³, that these effects give to a body that was made with the density `made_with`:
// ρ of this effect, or `made_with` without it.
double DensityWith(const EffectList& effects, double made_with);

// The effects in their order for a body that is made with DensityWith(): without this effect, and
// with α ρ₀/ρ for mass-proportional damping, whose force is thus the same. A force that an
// expression gives per mass is not changed.
EffectList WithDensityInBody(const EffectList& effects, double made_with);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_UNIFORM_DENSITY_H_
