// The part of a body's surface that lies on a bed, for effects that hold it there: the settings
// that name it, and its areas.
#ifndef LACUNA_EFFECTS_BEDDING_H_
#define LACUNA_EFFECTS_BEDDING_H_

#include <Eigen/Core>

#include "effects/rest_quantity.h"
#include "fem/body.h"
#include "record/effect_card.h"

namespace lacuna {

// The parameter `modulus`, k, Pa/m: pressure per displacement; the null value is 0.
ParameterCard BeddingModulus();

// Appends the settings `point` (c, m), `normal` and `radius` (r, m): the half-space n·(X − c) ≥ 0
// of the body at rest. A normal of length zero selects all of the surface, a radius of zero does
// not fade.
void AppendBeddedPart(EffectCard* card);

// The bedded part for an effect whose card ends with these settings. The areas are computed once
// for each mesh (rest_quantity.h), and several threads may call Areas.
class BeddedPart {
 public:
  // All parameters of the effect, in the order of its card; the last seven are the settings.
  void SetParameters(const Eigen::VectorXd& values);

  // w_i A_i at each node (n), m². Throws InputError, naming the effect by `type`, if no node of the
  // surface is held.
  std::shared_ptr<const Eigen::VectorXd> Areas(const Body& body, const std::string& type) const;

 private:
  static constexpr int kSettings = 7;
  Eigen::Vector<double, kSettings> settings_ =  // point, normal, radius
      Eigen::Vector<double, kSettings>::Zero();
  RestQuantity<Eigen::VectorXd> areas_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_BEDDING_H_
