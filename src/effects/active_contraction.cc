// Active contraction along one direction of the material, such as that of muscle or of an embedded
// actuator.
//
// The second Piola–Kirchhoff stress is T a ⊗ a, a pull along the direction a of the rest shape that
// does not depend on strain: the force per rest area on a face normal to a is T times the stretch.
#include <algorithm>

#include "effects/catalogue.h"
#include "effects/vector_parameters.h"
#include "fem/point_energy_effect.h"

namespace lacuna {
namespace {

class ActiveContractionLaw {
 public:
  enum Parameter { kTension, kAxis, kStart = kAxis + 3, kRise };

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit ActiveContractionLaw(const Eigen::VectorXd& parameters)
      : tension_(parameters[kTension]),
        axis_(parameters.segment<3>(kAxis).normalized()),
        start_(parameters[kStart]),
        rise_(parameters[kRise]) {
    CHECK_GT(parameters.segment<3>(kAxis).norm(), 0) << "a contraction needs a direction";
    CHECK_GE(rise_, 0);
  }

  double EnergyDensity(const Eigen::Matrix3d& F, const MaterialPoint& at) const {
    return 0.5 * tension_ * Activation(at.time) * ((F * axis_).squaredNorm() - 1);
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const MaterialPoint& at) const {
    return tension_ * StressDerivative(F, at, kTension);
  }

  StressTangent Tangent(const Eigen::Matrix3d& /*F*/, const MaterialPoint& at,
                        bool convexify) const {
    double slope = tension_ * Activation(at.time);
    if (convexify) slope = std::max(slope, 0.0);
    StressTangent tangent = StressTangent::Zero();
    for (int j = 0; j < 3; ++j) {
      for (int l = 0; l < 3; ++l) {
        tangent.block<3, 3>(3 * j, 3 * l).diagonal().setConstant(slope * axis_[j] * axis_[l]);
      }
    }
    return tangent;
  }

  Eigen::Matrix3d StressDerivative(const Eigen::Matrix3d& F, const MaterialPoint& at,
                                   int /*parameter*/) const {
    return Activation(at.time) * (F * axis_) * axis_.transpose();
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "active_contraction",
        .family = EffectFamily::kVolumeStress,
        .title = "Active contraction along a direction",
        .equation =
            "ψ = T g(t) (a·C·a − 1)/2,  C = FᵀF,  P = T g F a ⊗ a;  "
            "g = u² (3 − 2u), u = (t − t₀)/τ between 0 and 1",
        .citation =
            "M. P. Nash, P. J. Hunter, Computational Mechanics of the Heart, J. Elasticity 61, "
            "2000, 113–141",
        .parameters = {},
        .residual_when_missing =
            "Without a load that would cause it, the body contracts along one of its own "
            "directions, most where it is softest, and thickens across that direction.",
        .separating_experiment =
            "Switch the drive off, or wait for it to end: an active stress vanishes with it, "
            "whereas swelling and a wrong rest shape stay. Turn the body: the pull rotates with "
            "it, gravity does not. Add a load: the pull stays the same, that of stiffer fibres "
            "grows with their stretch",
        .look_alikes = {"swelling", "gravity", "fibre_stiffness"},
        .tried_at = TriedAlongDirections{},
        .trial = {.axis_along_bar = true},
        .repeatable = true,
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back({.name = "tension",
                               .meaning = "pull per area across the direction, T; negative where "
                                          "the body is driven to lengthen",
                               .dimension = kPressure,
                               .bounds = kAnyValue,
                               .null_value = 0,
                               .plausible_min = -1e4,
                               .plausible_max = 1e5,
                               .of_body = true,
                               .default_value = kMustBeGiven});
    AppendDirectionSetting("axis", "direction in the rest shape, of any length, a,",
                           Eigen::Vector3d::Constant(kMustBeGiven), &card);
    card.parameters.push_back({.name = "start",
                               .meaning = "time at which the pull sets in, t₀",
                               .dimension = kTime,
                               .bounds = kAnyValue,
                               .null_value = kNoNullValue,
                               .plausible_min = 0,
                               .plausible_max = 10,
                               .default_value = 0,
                               .setting = true});
    card.parameters.push_back({.name = "rise",
                               .meaning = "time from its onset to its full size, τ; 0: at once",
                               .dimension = kTime,
                               .bounds = kNotNegative,
                               .null_value = kNoNullValue,
                               .plausible_min = 0,
                               .plausible_max = 10,
                               .default_value = 0,
                               .setting = true});
    return card;
  }

  // g
  double Activation(double time) const {
    if (time >= start_ + rise_) return 1;
    if (time <= start_) return 0;
    const double u = (time - start_) / rise_;
    return u * u * (3 - 2 * u);
  }

  double tension_;        // T, Pa
  Eigen::Vector3d axis_;  // a, unit length
  double start_, rise_;   // s
};

}  // namespace

CatalogueEntry ActiveContraction() {
  return {&ActiveContractionLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<ActiveContractionLaw>>, &ReadParameters};
}

}  // namespace lacuna
