// The part of a body's surface that lies on a bed, for effects that hold it there: the parameters
// that name it, and its areas.
//
//   A_i w_i,  w_i = exp(−|X_i − c|²/(2 r²)) or 1,
// with the boundary area A_i around each node i that lies in the half-space and faces the side that
// the settings name. c and r may be fitted.
#ifndef LACUNA_EFFECTS_BEDDING_H_
#define LACUNA_EFFECTS_BEDDING_H_

#include <Eigen/Core>

#include "effects/rest_quantity.h"
#include "fem/body.h"
#include "record/effect_card.h"

namespace lacuna {

// The parameter `modulus`, k, Pa/m: pressure per displacement; the null value is 0.
ParameterCard BeddingModulus();

// Appends the place `point` (c, m), the setting `normal`, the `radius` (r, m) and the setting
// `side`. The half-space is n·(X − c) ≥ 0 of the body at rest; a normal of length zero selects all
// of the surface. With a radius of zero the support does not fade. `side` is an outward direction:
// the bed lies against that side of the body (FacingAreas in rest_region.h); of length zero, around
// the whole girth.
void AppendBeddedPart(EffectCard* card);

// The bedded part for an effect whose card ends with these parameters. The areas are computed once
// for each mesh (rest_quantity.h), and several threads may call the functions.
class BeddedPart {
 public:
  // The parameters that AppendBeddedPart appends, in their order.
  enum Parameter { kPoint, kNormal = kPoint + 3, kRadius = kNormal + 3, kSide, kCount = kSide + 3 };

  // All parameters of the effect, in the order of its card.
  void SetParameters(const Eigen::VectorXd& values);

  // w_i A_i at each node (n), m². Throws InputError, naming the effect by `type`, if no node of the
  // surface is held.
  std::shared_ptr<const Eigen::VectorXd> Areas(const Body& body, const std::string& type) const;

  // ∂(w_i A_i)/∂(parameter), m, for a component of c or for r: through w, at fixed A_i. It is zero
  // where the part does not fade. (The plane of the half-space moves along with c. Nodes that it
  // crosses change their A_i by jumps, which no derivative shows: to fit a place, name a side.)
  Eigen::VectorXd AreaDerivatives(const Body& body, const std::string& type, int parameter) const;

 private:
  Eigen::Vector3d Point() const { return values_.segment<3>(kPoint); }
  double Radius() const { return values_[kRadius]; }

  Eigen::Vector<double, kCount> values_ = Eigen::Vector<double, kCount>::Zero();
  RestQuantity<Eigen::VectorXd> areas_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_BEDDING_H_
