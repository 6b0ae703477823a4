// The part of gravity that other modules use: the acceleration of free fall of a model.
//
//   f_i = m_i g   (I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687),
// with the lumped mass m_i of node i. Other accelerations of the laboratory are described alike.
#ifndef LACUNA_EFFECTS_GRAVITY_H_
#define LACUNA_EFFECTS_GRAVITY_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "effects/free_fall.h"
#include "fem/model.h"

namespace lacuna {

const EffectCard& GravityCard();
bool IsGravity(const Effect& effect);

// `acceleration`: g, m/s².
std::shared_ptr<const Effect> MakeGravity(const Eigen::Vector3d& acceleration);

// The acceleration of free fall g, m/s², of a model with these effects; nothing for a model without
// gravity. A model contains gravity once at most: it is not repeatable.
std::optional<Eigen::Vector3d> GravityOf(const EffectList& effects);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_GRAVITY_H_
