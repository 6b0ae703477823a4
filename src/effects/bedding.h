// The part of a body's surface that lies on a bed, for effects that hold it there: the settings that
// name it, and its areas.
#ifndef LACUNA_EFFECTS_BEDDING_H_
#define LACUNA_EFFECTS_BEDDING_H_

#include <Eigen/Core>

#include "effects/rest_quantity.h"
#include "fem/body.h"
#include "record/effect_card.h"

namespace lacuna {

// Pa/m: a pressure per displacement.
ParameterCard BeddingModulus();

// Adds the settings `point`, `normal` and `radius`: the boundary nodes of a half-space of the body
// at rest, fading as exp(−|X − c|²/(2 r²)) where a radius is given.
void AppendBeddedPart(EffectCard* card);

// What an effect whose card ends with these settings holds.
class BeddedPart {
 public:
  // The effect's parameters, in the order of its card.
  void SetParameters(const Eigen::VectorXd& values);

  // w_i A_i (n, m²). Throws InputError, naming the effect's `type`, where no node of the surface is
  // held.
  std::shared_ptr<const Eigen::VectorXd> Areas(const Body& body, const std::string& type) const;

 private:
  static constexpr int kSettings = 7;
  Eigen::Vector<double, kSettings> settings_ =  // point, normal, radius
      Eigen::Vector<double, kSettings>::Zero();
  RestQuantity<Eigen::VectorXd> areas_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_BEDDING_H_
