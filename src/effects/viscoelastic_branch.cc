// One branch of a generalised Maxwell solid (a Prony series): a spring of modulus m and a dashpot
// in series, beside the elasticity of the body.
//
// Over-stress Q with  Q̇ + Q/τ = C : Ḃ,  C Hooke's moduli for m and ν, and the strain B of
// fem/branch_strain.h. This is Simo's model with a stress that is linear in B, for the reasons in
// fem/memory_branch.h; for τ → 0 at constant m τ it becomes stiffness_damping at small strain. The
// free energy of the branch is ½ Q : C⁻¹ : Q, its dissipation Q : C⁻¹ : Q/τ ≥ 0, at any strain.
//
// C is that of a full isotropic solid, not only of its deviator: with the Poisson ratio of the
// material (the default) the branch is a scaled copy of it at small strain, so that m is the extra
// Young's modulus that a sudden stretch meets, a held body relaxes without changing shape, and
// nearly incompressible bodies stay so.
//
// Update (R. L. Taylor, K. S. Pister, G. L. Goudreau 1970): exact for a strain that changes
// linearly in the step,
//   e₁ = a e₀ + b (B₁ − B₀),    a = exp(−h/τ),    b = (1 − a) τ/h,    Q = C : e,
// hence exact in a hold, otherwise of second order, and stable for any h/τ. A point stores e and B.
// Statics is the limit of a very slow motion: e = 0.
#include <cmath>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/standard_cards.h"
#include "fem/memory_branch.h"

namespace lacuna {
namespace {

class ViscoelasticLaw {
 public:
  enum Parameter { kModulus, kRelaxationTime, kPoissonRatio };
  static constexpr int kStateSize = 12;  // e, B
  using State = Eigen::Matrix<double, kStateSize, 1>;

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  ViscoelasticLaw(const Eigen::VectorXd& parameters, double time_step)
      : moduli_(IsotropicModuli(LameByYoungModulus(parameters[kPoissonRatio]))) {
    if (time_step == 0) return;
    const double steps = time_step / parameters[kRelaxationTime];
    decay_ = std::exp(-steps);
    gain_ = -std::expm1(-steps) / steps;
    decay_derivative_ = decay_ * steps / parameters[kRelaxationTime];
    gain_derivative_ = (gain_ - decay_) / parameters[kRelaxationTime];
  }

  double Potential(const KelvinVector& strain, const State& state) const {
    const KelvinVector change = strain - state.tail<6>();
    return change.dot(moduli_ * (decay_ * state.head<6>() + 0.5 * gain_ * change));
  }

  KelvinVector Stress(const KelvinVector& strain, const State& state) const {
    return moduli_ * SpringStrain(strain, state);
  }

  KelvinMatrix Moduli(const KelvinVector& /*strain*/, const State& /*state*/) const {
    return gain_ * moduli_;
  }

  KelvinVector StressDerivative(const KelvinVector& strain, const State& state,
                                int /*parameter: relaxation_time*/) const {
    return moduli_ * SpringStrainDerivative(strain, state);
  }

  State AtEnd(const KelvinVector& strain, const State& state) const {
    return (State() << SpringStrain(strain, state), strain).finished();
  }

  KelvinVector StressChange(const KelvinVector& /*strain*/, const State& /*state*/,
                            const State& change) const {
    return moduli_ * SpringStrain(KelvinVector::Zero(), change);
  }
  State AtEndChange(const KelvinVector& /*strain*/, const State& /*state*/,
                    const KelvinVector& strain_change, const State& change) const {
    return AtEnd(strain_change, change);  // which is linear
  }
  State AtEndDerivative(const KelvinVector& strain, const State& state,
                        int /*parameter: relaxation_time*/) const {
    return (State() << SpringStrainDerivative(strain, state), KelvinVector::Zero()).finished();
  }

 private:
  static EffectCard MakeCard() {
    return {
        .type = "viscoelastic_branch",
        .family = EffectFamily::kLossInside,
        .title = "Viscoelastic branch (Maxwell element of a Prony series)",
        .equation =
            "P = F dev Q + ⅓ (tr Q) cof F,  dQ/dt + Q/τ = d/dt (λ (tr B) I + 2μ B),  "
            "B = dev E + ⅓ (J − 1) I,  E = ½ (FᵀF − I),  J = det F,  λ and μ from modulus m and "
            "Poisson ratio;  in a sudden stretch ε held: stress m ε exp(−t/τ) on top of the "
            "elastic one",
        .citation =
            "J. C. Simo, On a Fully Three-dimensional Finite-strain Viscoelastic Damage Model, "
            "Computer Methods in Applied Mechanics and Engineering 60, 1987; G. A. Holzapfel, "
            "Nonlinear Solid Mechanics, Wiley 2000, sec. 6.10; update: R. L. Taylor, K. S. "
            "Pister, G. L. Goudreau, Thermomechanical Analysis of Viscoelastic Solids, "
            "International Journal for Numerical Methods in Engineering 2, 1970",
        .parameters = {BranchModulus(
                           "Young's modulus that the branch adds to a sudden stretch, m; for soft "
                           "solids a tenth to once that of the material"),
                       {.name = "relaxation_time",
                        .meaning =
                            "time in which the stress of the branch falls to 37 % in a hold, τ; a "
                            "recording determines values between its frame interval and duration",
                        .dimension = kTime,
                        .bounds = kPositive,
                        .null_value = kNoNullValue,
                        .plausible_min = 1e-3,
                        .plausible_max = 1e2,
                        .default_value = kMustBeGiven,
                        .log_scale = true,
                        .trial = {.min = 0.02, .max = 0.3, .draw = 1}},
                       BranchPoissonRatio()},
        .residual_when_missing =
            "The body creeps under a constant load, or the force relaxes while the body is held, "
            "with the shape of the elastic deformation. Fast loading appears stiffer than slow "
            "loading, and oscillations decay most where their period is about 6 τ.",
        .separating_experiment =
            "Stretch quickly, hold for several τ, release and wait: here the force relaxes over τ "
            "and the rest shape is recovered; stiffness-proportional damping exerts no force while "
            "the body is held; a yielding branch keeps its force while held and leaves a permanent "
            "set. Two frequencies distinguish a branch from both kinds of damping",
        .look_alikes = {"stiffness_damping", "mass_damping", "elastoplastic_branch", "softening"},
        .tried_at = TriedAtRelaxationTimes{"relaxation_time", "τ"},
        .repeatable = true,
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
  }

  KelvinVector SpringStrain(const KelvinVector& strain, const State& state) const {
    return decay_ * state.head<6>() + gain_ * (strain - state.tail<6>());
  }

  // Its derivative with respect to the relaxation time, 1/s.
  KelvinVector SpringStrainDerivative(const KelvinVector& strain, const State& state) const {
    return decay_derivative_ * state.head<6>() + gain_derivative_ * (strain - state.tail<6>());
  }

  KelvinMatrix moduli_;                                // C for m = 1
  double decay_ = 0, gain_ = 0;                        // a, b
  double decay_derivative_ = 0, gain_derivative_ = 0;  // ∂a/∂τ, ∂b/∂τ, 1/s
};

}  // namespace

const EffectCard& ViscoelasticBranchCard() { return ViscoelasticLaw::Card(); }

CatalogueEntry ViscoelasticBranch() {
  return {&ViscoelasticLaw::Card(), CatalogueEntry::Kind::kEffect,
          &MakeAs<MemoryBranch<ViscoelasticLaw>>, &ReadParameters};
}

}  // namespace lacuna
