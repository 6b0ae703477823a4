#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/neo_hookean_energy.h"
#include "effects/standard_cards.h"
#include "fem/elastic_solid.h"

namespace lacuna {
namespace {

class NeoHookeanLaw : public NeoHookeanEnergy {
 public:
  using NeoHookeanEnergy::NeoHookeanEnergy;

  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "neo_hookean",
        .family = EffectFamily::kElasticity,
        .title = "Neo-Hookean elasticity",
        .equation =
            "ψ = μ/2 (F:F − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)²,  J = det F,  "
            "P = μ F + ((λ + μ)(J − 1) − μ) ∂J/∂F",
        .citation =
            "B. Smith, F. de Goes, T. Kim, Stable Neo-Hookean Flesh Simulation, ACM TOG "
            "37(2), 2018, Eq. 13; L. R. G. Treloar, The Elasticity of a Network of "
            "Long-Chain Molecules II, Trans. Faraday Soc. 39, 1943",
        .parameters = ElasticParameters(),
        .residual_when_missing =
            "Measured tension softens more than the fitted law predicts (about as 1/length²), and "
            "large compression is much stiffer.",
        .separating_experiment =
            "Stretch by more than 30 %: the force of a rubber falls below the straight line, that "
            "of St. Venant–Kirchhoff rises above it. Compress to half the length: only this law "
            "resists without buckling elements",
        .look_alikes = {"linear", "corotational", "st_venant_kirchhoff", "strain_stiffening"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    return card;
  }
};

}  // namespace

const EffectCard& NeoHookeanCard() { return NeoHookeanLaw::Card(); }

CatalogueEntry NeoHookean() {
  return {&NeoHookeanLaw::Card(), CatalogueEntry::Kind::kMaterial,
          &MakeAs<ElasticSolid<NeoHookeanLaw>>, &ReadParameters};
}

}  // namespace lacuna
