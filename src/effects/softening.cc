// A branch that softens with the largest strain of its history (the Mullins effect): a body is
// stiffer on its first stretch than on later ones up to the same stretch, at any speed, without
// permanent set.
//
//   Q = m g(κ) C : B,   g = 1/(1 + κ/κ₀),   κ = largest √(B : C : B) so far, the present included,
// with Hooke's moduli C for Young's modulus 1 and the strain B of fem/branch_strain.h: damage
// driven by the energy norm of the strain (Simo 1987). On first loading the stress m κ/(1 + κ/κ₀)
// still rises, towards m κ₀; so the incremental potential is convex and strain does not localise in
// single elements, as it would if g decreased faster than 1/κ. The elasticity law of the body is
// the limit of complete softening: the branch adds a stiffness that decreases to zero and never
// reduces that of the body. It is independent of the rate, and statics is a step like any other.
#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "fem/memory_branch.h"

namespace lacuna {
namespace {

class SofteningLaw {
 public:
  enum Parameter { kModulus, kSofteningStrain, kPoissonRatio };
  static constexpr int kStateSize = 1;  // κ at the start of the step
  using State = Eigen::Matrix<double, kStateSize, 1>;

  static const EffectCard& Card() {
    static const EffectCard card = MakeCard();
    return card;
  }

  SofteningLaw(const Eigen::VectorXd& parameters, double /*time_step*/)
      : moduli_(IsotropicModuli(LameByYoungModulus(parameters[kPoissonRatio]))),
        softening_strain_(parameters[kSofteningStrain]) {}

  double Potential(const KelvinVector& strain, const State& state) const {
    const double before = state[0], now = Norm(strain);
    if (now <= before) return 0.5 * Remaining(before) * now * now;
    // ∫ κ g(κ) dκ from the largest past strain on.
    const double c = softening_strain_;
    return 0.5 * Remaining(before) * before * before +
           c * (now - before - c * std::log1p((now - before) / (c + before)));
  }

  KelvinVector Stress(const KelvinVector& strain, const State& state) const {
    return Remaining(AtEnd(strain, state)[0]) * moduli_ * strain;
  }

  KelvinMatrix Moduli(const KelvinVector& strain, const State& state) const {
    const double now = Norm(strain);
    if (now <= state[0]) return Remaining(state[0]) * moduli_;
    const KelvinVector elastic = moduli_ * strain;
    const double g = Remaining(now);
    return g * moduli_ - (g * g / (softening_strain_ * now)) * elastic * elastic.transpose();
  }

  KelvinVector StressDerivative(const KelvinVector& strain, const State& state,
                                int /*parameter: softening_strain*/) const {
    const double largest = AtEnd(strain, state)[0];
    const double g = Remaining(largest);
    return (g * g * largest / (softening_strain_ * softening_strain_)) * moduli_ * strain;
  }

  State AtEnd(const KelvinVector& strain, const State& state) const {
    return State(std::max(state[0], Norm(strain)));
  }

  KelvinVector StressChange(const KelvinVector& strain, const State& state,
                            const State& change) const {
    if (Norm(strain) > state[0]) return KelvinVector::Zero();
    const double g = Remaining(state[0]);
    return (-g * g / softening_strain_ * change[0]) * moduli_ * strain;
  }
  State AtEndChange(const KelvinVector& strain, const State& state,
                    const KelvinVector& strain_change, const State& change) const {
    const double now = Norm(strain);
    return now > state[0] ? State(strain_change.dot(moduli_ * strain) / now) : change;
  }
  State AtEndDerivative(const KelvinVector& /*strain*/, const State& /*state*/,
                        int /*parameter*/) const {
    return State::Zero();
  }

 private:
  static EffectCard MakeCard() {
    return {
        .type = "softening",
        .family = EffectFamily::kElasticity,
        .title = "Softening by the largest past strain (Mullins effect)",
        .equation =
            "P = F dev Q + ⅓ (tr Q) cof F,  Q = (λ (tr B) I + 2μ B)/(1 + κ/κ₀),  "
            "κ = largest √(B:C:B) so far (in a bar: the largest strain),  "
            "B = dev E + ⅓ (J − 1) I,  E = ½ (FᵀF − I),  J = det F,  λ, μ from modulus m and "
            "Poisson ratio, C from the same with m = 1",
        .citation =
            "L. Mullins, Softening of Rubber by Deformation, Rubber Chemistry and Technology "
            "42, 1969; J. C. Simo, On a Fully Three-dimensional Finite-strain Viscoelastic "
            "Damage Model, Computer Methods in Applied Mechanics and Engineering 60, 1987",
        .parameters = {BranchModulus(
                           "Young's modulus that the undamaged body has in addition to that of a "
                           "fully softened one, m; for filled rubbers up to that of the material"),
                       {.name = "softening_strain",
                        .meaning = "largest past strain at which half of the modulus is gone, κ₀",
                        .dimension = kDimensionless,
                        .bounds = kPositive,
                        .null_value = kNoNullValue,
                        .plausible_min = 0.01,
                        .plausible_max = 1,
                        .default_value = kMustBeGiven,
                        .log_scale = true,
                        .trial = {.min = 0.03, .max = 0.2, .draw = 3}},
                       BranchPoissonRatio()},
        .residual_when_missing =
            "The same load displaces the body further the second time. Force against displacement "
            "of the first loading lies above that of all later ones, which agree with each other "
            "and end at the same rest shape.",
        .separating_experiment =
            "Repeat one cycle three times: only the first differs, whereas the loop of a yielding "
            "or viscoelastic branch repeats each time. Then stretch further: the curve of the "
            "first loading continues where it ended",
        .look_alikes = {"elastoplastic_branch", "viscoelastic_branch"},
        .tried_at = TriedAtValues{"softening_strain", "κ₀", {0.1}},
        .repeatable = true,
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
  }

  double Norm(const KelvinVector& strain) const { return std::sqrt(strain.dot(moduli_ * strain)); }
  // g
  double Remaining(double largest) const { return 1 / (1 + largest / softening_strain_); }

  KelvinMatrix moduli_;      // C
  double softening_strain_;  // κ₀
};

}  // namespace

CatalogueEntry Softening() {
  return {&SofteningLaw::Card(), CatalogueEntry::Kind::kEffect, &MakeAs<MemoryBranch<SofteningLaw>>,
          &ReadParameters};
}

}  // namespace lacuna
