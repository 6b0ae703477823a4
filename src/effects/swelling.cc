// Swelling or shrinking: without stress the body would be larger than its rest shape by a linear
// strain ε, because of the uptake of a liquid, heat (ε = α ΔT) or curing (ε < 0).
//
//   ψ = −3 K ε (J − 1)
// adds the Cauchy stress −3 K ε I at any deformation, the thermal stress of small-strain
// elasticity: a free body grows by ε (to first order), a body that is held on all sides exerts the
// pressure 3 K ε = E ε/(1 − 2ν). As that stress is uniform, its nodal forces act on the boundary
// only. K belongs to the effect: when a fit changes the modulus of the material, 3 K ε stays the
// same, and ε refers to the K given here.
#include <Eigen/LU>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/strain_invariants.h"
#include "fem/point_energy_effect.h"

namespace lacuna {
namespace {

class SwellingLaw {
 public:
  enum Parameter { kStrain, kYoungModulus, kPoissonRatio };

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit SwellingLaw(const Eigen::VectorXd& parameters)
      : strain_(parameters[kStrain]),
        pressure_per_strain_(parameters[kYoungModulus] / (1 - 2 * parameters[kPoissonRatio])) {}

  double EnergyDensity(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    return -Pressure() * InvariantsOf(F).dilatation;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/) const {
    return -Pressure() * Cofactor(F);
  }

  StressTangent Tangent(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                        bool convexify) const {
    if (convexify) {
      const SignedSvd axes = ComputeSignedSvd(F);
      PrincipalTangent principal = PrincipalTangent::Zero();
      principal.AddVolumetric(axes.stretch, -Pressure(), 0);
      return ProjectedTangent(axes, principal);
    }
    StressTangent tangent = StressTangent::Zero();
    AddCofactorDerivative(F, -Pressure(), &tangent);
    return tangent;
  }

  Eigen::Matrix3d StressDerivative(const Eigen::Matrix3d& F, const MaterialPoint& /*at*/,
                                   int /*parameter*/) const {
    return -pressure_per_strain_ * Cofactor(F);
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "swelling",
        .family = EffectFamily::kVolumeStress,
        .title = "Swelling, shrinking or thermal expansion",
        .equation = "ψ = −3 K ε (J − 1),  J = det F,  3 K = E/(1 − 2ν),  P = −3 K ε ∂J/∂F",
        .citation =
            "J. M. C. Duhamel, Second mémoire sur les phénomènes thermo-mécaniques, J. de l'École "
            "Polytechnique 15, 1837, 1–57; B. A. Boley, J. H. Weiner, Theory of Thermal Stresses, "
            "Wiley 1960, ch. 1",
        .parameters = {},
        .residual_when_missing =
            "Even without load the body is larger, or smaller, than its rest shape by the same "
            "ratio in all directions, and bulges beside a clamp that prevents its growth. The "
            "residual does not change with the load.",
        .separating_experiment =
            "Remove all load and turn the body upside down: swelling stays as it is, the sag of "
            "gravity changes sign. Free the clamp: a swollen body then has the same shape, only "
            "larger",
        .look_alikes = {"gravity", "active_contraction", "pressure"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    card.parameters.push_back({.name = "strain",
                               .meaning = "linear strain that the body would have if it were free, "
                                          "ε; negative where it shrinks",
                               .dimension = kDimensionless,
                               .bounds = {-1, 10, true, false},
                               .null_value = 0,
                               .plausible_min = -0.1,
                               .plausible_max = 0.1,
                               .default_value = kMustBeGiven});
    for (ParameterCard& setting : ElasticSettings()) card.parameters.push_back(std::move(setting));
    return card;
  }

  double Pressure() const { return pressure_per_strain_ * strain_; }

  double strain_;               // ε
  double pressure_per_strain_;  // 3 K, Pa
};

}  // namespace

CatalogueEntry Swelling() {
  return {&SwellingLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PointEnergyEffect<SwellingLaw>>, &ReadParameters};
}

}  // namespace lacuna
