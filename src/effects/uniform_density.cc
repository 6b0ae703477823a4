#include "effects/uniform_density.h"

#include "effects/added_mass.h"
#include "effects/gravity.h"
#include "effects/rest_region.h"
#include "effects/standard_cards.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class UniformDensityEffect final : public CloneableEffect<UniformDensityEffect, AddedMass> {
 public:
  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit UniformDensityEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }

 private:
  double Size(const Body& body) const override { return parameters_[0] - body.density; }
  Eigen::VectorXd MassPerUnit(const Body& body) const override { return NodeVolumes(body); }

  static EffectCard MakeCard() {
    EffectCard card{
        .type = "uniform_density",
        .family = EffectFamily::kMassDistribution,
        .title = "Density of the body",
        .equation = "f_i = (ρ − ρ₀) V_i (g − a_i)",
        .citation = "I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687 (second law)",
        .parameters = {{.name = "density",
                        .meaning = "density of the body, ρ",
                        .dimension = kDensity,
                        .bounds = kPositive,
                        .null_value = kNoNullValue,
                        .plausible_min = 500,
                        .plausible_max = 2000,
                        .default_value = kMustBeGiven,
                        .log_scale = true}},
        .residual_when_missing =
            "Sag and inertia are too large or too small everywhere by the same share: the moduli "
            "of a body that moves under its own weight alone are off by that share.",
        .separating_experiment =
            "Weigh the body and measure its volume; or load it with a known weight, whose effect "
            "does not depend on the density",
        .look_alikes = {},
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendGravitySetting(&card);
    return card;
  }
};

}  // namespace

std::shared_ptr<const Effect> MakeUniformDensity(double density, const Eigen::Vector3d& gravity) {
  Eigen::VectorXd parameters(4);
  parameters << density, gravity;
  return std::make_shared<UniformDensityEffect>(parameters);
}

bool IsUniformDensity(const Effect& effect) {
  return &effect.Card() == &UniformDensityEffect::TheCard();
}

double DensityWith(const EffectList& effects, double made_with) {
  for (const auto& effect : effects)
    if (IsUniformDensity(*effect)) return effect->Parameters()[0];
  return made_with;
}

EffectList WithDensityInBody(const EffectList& effects, double made_with) {
  const double ratio = made_with / DensityWith(effects, made_with);
  EffectList others;
  for (const auto& effect : effects) {
    if (IsUniformDensity(*effect)) continue;
    const bool is_mass_damping = &effect->Card() == &MassDampingCard();
    others.push_back(is_mass_damping ? effect->WithParameters(ratio * effect->Parameters())
                                     : effect);
  }
  return others;
}

}  // namespace lacuna
