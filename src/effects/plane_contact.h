// The part of plane contact that other modules use: adding a plane to a model, and finding the
// plane of a model.
//
// The body touches the half-space n·x < c. The law, its source and its parameters are in
// plane_contact.cc.
#ifndef LACUNA_EFFECTS_PLANE_CONTACT_H_
#define LACUNA_EFFECTS_PLANE_CONTACT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "fem/model.h"

namespace lacuna {

struct ContactPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // n: away from the half-space, any length
  double offset = 0;                                  // c, m: the height along the unit normal
  double stiffness = 0;                               // k, Pa/m: pressure per penetration depth
  double friction = 0;                                // μ: coefficient of Coulomb friction
};

const EffectCard& PlaneContactCard();

// The other parameters of the effect take the default values of its card.
std::shared_ptr<const Effect> MakePlaneContact(const ContactPlane& plane);

// The plane of a contact; nothing for any other effect.
std::optional<ContactPlane> ContactPlaneOf(const Effect& effect);

// The first contact among these effects, owned by them; null if there is none.
const Effect* FindPlaneContact(const EffectList& effects);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_PLANE_CONTACT_H_
