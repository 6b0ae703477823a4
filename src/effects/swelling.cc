// Swelling or shrinking: without stress the body would be larger than its rest shape by a linear
// strain ε in all directions, because of the uptake of a liquid, heat (ε = α ΔT) or curing (ε < 0).
//
// The strain is free of the moduli: the deformation gradient is split into the swelling and an
// elastic part, F = F_e F_s with F_s = (1 + ε) I, and the elasticity law of the body, whichever it
// is and with its present parameters, stores energy for the elastic part only,
//   ψ = J_s ψ_el(F_e),  F_e = F/(1 + ε),  J_s = (1 + ε)³.
// This effect adds the difference to the energy that the law itself adds, ψ − ψ_el(F). A free body
// is larger by exactly ε; one that is held on all sides is under the pressure E ε/(1 − 2ν) to first
// order. As F/(1 + ε) is the deformation gradient of the positions x/(1 + ε), everything follows
// from the law at these positions: with s = 1 + ε and the law's force f_el, energy E_el and
// derivative K_el = ∂f_el/∂x,
//   f = s² f_el(x/s) − f_el(x),   E = s³ E_el(x/s) − E_el(x),   ∂f/∂x = s K_el(x/s) − K_el(x),
//   ∂f/∂ε = 2 s f_el(x/s) − K_el(x/s) x.
// Stresses of other effects refer to F, not to F_e: an inclusion, a gradient of stiffness, fibres
// or a branch adds a material that does not swell, and a swollen body that contains it is under
// stress even if it is free.
#include <glog/logging.h>

#include "effects/catalogue.h"
#include "effects/free_strain.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class SwellingEffect final : public CloneableEffect<SwellingEffect, FreeStrain> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit SwellingEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, strain_); }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 1);
    CHECK_GT(values[0], -1);
    strain_ = values[0];
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, 0);
    WithElasticPart(at, [&](const ElasticPart& elastic) {
      AddForceAndStiffness(at, elastic.state, 2 * Stretch(), derivative);
    });
  }

 private:
  bool HasNoStrain() const override { return strain_ == 0; }

  void WithElasticPart(const Kinematics& at,
                       const std::function<void(const ElasticPart&)>& use) const override {
    const double s = Stretch();
    const Eigen::VectorXd position = at.position / s;
    use({AsSeenByLaw(at, at.body, position), s * s, s, s * s * s});
  }

  Eigen::VectorXd Stretches(const Body& body) const override {
    return Eigen::VectorXd::Constant(body.PointCount(), Stretch());
  }

  static EffectCard MakeCard() {
    return {.type = "swelling",
            .family = EffectFamily::kVolumeStress,
            .title = "Swelling, shrinking or thermal expansion",
            .equation =
                "ψ = (1 + ε)³ ψ_el(F/(1 + ε)) − ψ_el(F),  ψ_el the body's elasticity law. "
                "What other effects add to the material, such as an inclusion or fibres, "
                "refers to F: it does not swell",
            .citation =
                "J. M. C. Duhamel, Second mémoire sur les phénomènes thermo-mécaniques, J. de "
                "l'École Polytechnique 15, 1837, 1–57; the multiplicative split: E. K. Rodriguez, "
                "A. Hoger, A. D. McCulloch, Stress-Dependent Finite Growth in Soft Elastic "
                "Tissues, Journal of Biomechanics 27, 1994, 455–467",
            .parameters = {{.name = "strain",
                            .meaning = "linear strain that the body would have if it were free "
                                       "and of the elasticity law alone, ε; negative where it "
                                       "shrinks",
                            .dimension = kDimensionless,
                            .bounds = {-1, 10, true, false},
                            .null_value = 0,
                            .plausible_min = -0.1,
                            .plausible_max = 0.1,
                            .default_value = kMustBeGiven}},
            .residual_when_missing =
                "Even without load the body is larger, or smaller, than its rest shape by the same "
                "ratio in all directions, and bulges beside a clamp that prevents its growth. The "
                "residual does not change with the load.",
            .separating_experiment =
                "Remove all load and turn the body upside down: swelling stays as it is, the sag "
                "of gravity changes sign. Free the clamp: a swollen body then has the same shape, "
                "only larger",
            .look_alikes = {"gravity", "active_contraction", "pressure"},
            .conserves_momentum = true,
            .conserves_angular_momentum = true};
  }

  double Stretch() const { return 1 + strain_; }

  double strain_ = 0;  // ε
};

Eigen::VectorXd ReadSwelling(const EffectCard& card, const Config& config, const Effect* material,
                             const std::optional<Eigen::Vector3d>& gravity) {
  for (const char* modulus : {"young_modulus", "poisson_ratio"})
    if (config.Has(modulus))
      config.Fail(modulus,
                  "is no longer needed: the strain is independent of the moduli, and those of the "
                  "material apply; leave it out");
  return ReadParameters(card, config, material, gravity);
}

}  // namespace

CatalogueEntry Swelling() {
  return {&SwellingEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<SwellingEffect>,
          &ReadSwelling};
}

}  // namespace lacuna
