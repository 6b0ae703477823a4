// An elastic–perfectly plastic branch (a Prandtl or Jenkin element) beside the elasticity of the
// body: a spring in series with a slider. With the elastic law in parallel the whole hardens
// kinematically, has a hysteresis loop at any speed and a permanent set; several branches of
// different yield strains make Masing's model of a smooth loop.
//
//   Q = 2μ (dev E − E_p),  2μ = 2m/3,  ‖dev E − E_p‖ ≤ √(3/2) ε_y,
// J2 plasticity in (Q, E), additive in the strain (Green & Naghdi 1965), for the reasons in
// fem/memory_branch.h. The branch resists changes of shape only; where volume is kept, m is its
// Young's modulus 3μ, ε_y the stretch at which a bar yields and m ε_y its yield stress. Yield is
// stated as a strain so that E_p does not depend on m.
//
// Radial return at the end of the step (radial_return.h); its incremental potential is quadratic up
// to yield and linear beyond. The law does not depend on the rate, so statics is a step like any
// other.
#include <cmath>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/radial_return.h"
#include "fem/memory_branch.h"

namespace lacuna {
namespace {

class ElastoplasticLaw {
 public:
  enum Parameter { kModulus, kYieldStrain };
  static constexpr int kStateSize = 6;  // E_p
  using State = KelvinVector;

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  ElastoplasticLaw(const Eigen::VectorXd& parameters, double /*time_step*/)
      : radius_(kNormOfUnitStretch * parameters[kYieldStrain]) {}

  double Potential(const KelvinVector& strain, const State& plastic) const {
    const double norm = Trial(strain, plastic).norm();
    return norm <= radius_ ? 0.5 * kTwoMu * norm * norm : kTwoMu * radius_ * (norm - 0.5 * radius_);
  }

  KelvinVector Stress(const KelvinVector& strain, const State& plastic) const {
    return kTwoMu * RadialReturn(Trial(strain, plastic), radius_);
  }

  KelvinMatrix Moduli(const KelvinVector& strain, const State& plastic) const {
    const KelvinVector trial = Trial(strain, plastic);
    KelvinMatrix moduli;
    for (int k = 0; k < 6; ++k)
      moduli.col(k) = kTwoMu * RadialReturnChange(trial, radius_, Deviator(KelvinVector::Unit(k)));
    return moduli;
  }

  KelvinVector StressDerivative(const KelvinVector& strain, const State& plastic,
                                int /*parameter: yield_strain*/) const {
    return kTwoMu * ElasticDerivative(Trial(strain, plastic));
  }

  State AtEnd(const KelvinVector& strain, const State& plastic) const {
    return Deviator(strain) - RadialReturn(Trial(strain, plastic), radius_);
  }

  KelvinVector StressChange(const KelvinVector& strain, const State& plastic,
                            const State& change) const {
    return -kTwoMu * RadialReturnChange(Trial(strain, plastic), radius_, change);
  }
  State AtEndChange(const KelvinVector& strain, const State& plastic,
                    const KelvinVector& strain_change, const State& change) const {
    return Deviator(strain_change) -
           RadialReturnChange(Trial(strain, plastic), radius_, Trial(strain_change, change));
  }
  State AtEndDerivative(const KelvinVector& strain, const State& plastic,
                        int /*parameter: yield_strain*/) const {
    return -ElasticDerivative(Trial(strain, plastic));
  }

 private:
  static constexpr double kTwoMu = 2.0 / 3;                         // 2μ for m = 1
  static constexpr double kNormOfUnitStretch = 1.2247448713915890;  // ‖diag(1, −½, −½)‖ = √(3/2)

  static EffectCard MakeCard() {
    return {.type = "elastoplastic_branch",
            .family = EffectFamily::kLossInside,
            .title = "Elastic–perfectly plastic branch (Prandtl element)",
            .equation =
                "P = F S,  S = (2m/3) (dev E − E_p),  ‖dev E − E_p‖ ≤ √(3/2) ε_y,  E_p flows along "
                "S at the limit only,  E = ½ (FᵀF − I);  in a slender bar at constant volume: "
                "modulus m up to the strain ε_y, then the constant stress m ε_y",
            .citation =
                "L. Prandtl, Ein Gedankenmodell zur kinetischen Theorie der festen Körper, "
                "Zeitschrift für angewandte Mathematik und Mechanik 8, 1928; G. Masing, "
                "Eigenspannungen und Verfestigung beim Messing, 1926; radial return: M. L. "
                "Wilkins, Calculation of Elastic-plastic Flow, 1964; J. C. Simo, T. J. R. Hughes, "
                "Computational Inelasticity, Springer 1998, ch. 3; finite strain: A. E. Green, "
                "P. M. Naghdi, A General Theory of an Elastic-plastic Continuum, Archive for "
                "Rational Mechanics and Analysis 18, 1965",
            .parameters = {BranchModulus(
                               "Young's modulus that the branch adds before it yields (three times "
                               "its shear modulus), m; for soft solids a tenth to once that of the "
                               "material"),
                           {.name = "yield_strain",
                            .meaning =
                                "stretch at which a bar starts to flow, ε_y; from stiff pastes to "
                                "soft foams",
                            .dimension = kDimensionless,
                            .bounds = kPositive,
                            .null_value = kNoNullValue,
                            .plausible_min = 1e-3,
                            .plausible_max = 0.3,
                            .default_value = kMustBeGiven,
                            .log_scale = true,
                            .trial = {.min = 0.005, .max = 0.03, .draw = 2}}},
            .residual_when_missing =
                "After unloading the body does not return to its rest shape; the permanent set is "
                "largest where the strain was largest. Force against displacement is a loop whose "
                "area does not depend on the speed.",
            .separating_experiment =
                "Load, unload and scan again after a long rest: a permanent set remains, whereas a "
                "viscoelastic branch recovers. Run the loop at half the speed: here its width "
                "stays the same, with any damping it changes",
            .look_alikes = {"viscoelastic_branch", "softening", "stiffness_damping", "mass_damping",
                            "slipping_support"},
            .tried_at = TriedAtValues{"yield_strain", "yield at a strain", {0.01, 0.05}},
            .repeatable = true,
            .conserves_momentum = true,
            .conserves_angular_momentum = true};
  }

  static KelvinVector Trial(const KelvinVector& strain, const State& plastic) {
    return Deviator(strain) - plastic;
  }

  // The derivative of the elastic strain at the end of the step with respect to the yield strain.
  KelvinVector ElasticDerivative(const KelvinVector& trial) const {
    const double norm = trial.norm();
    if (norm <= radius_) return KelvinVector::Zero();
    return (kNormOfUnitStretch / norm) * trial;
  }

  double radius_;  // √(3/2) ε_y
};

}  // namespace

CatalogueEntry ElastoplasticBranch() {
  return {&ElastoplasticLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<MemoryBranch<ElastoplasticLaw>>, &ReadParameters};
}

}  // namespace lacuna
