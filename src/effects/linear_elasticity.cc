// Small-strain linear elasticity (Hooke's law).
#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/standard_cards.h"
#include "fem/elastic_solid.h"

namespace lacuna {
namespace {

class LinearLaw {
 public:
  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "linear",
        .family = EffectFamily::kElasticity,
        .title = "Linear elasticity",
        .equation = "ψ = μ ε:ε + λ/2 (tr ε)²,  ε = ½ (F + Fᵀ) − I,  P = 2μ ε + λ (tr ε) I",
        .citation =
            "R. Hooke, De Potentia Restitutiva, 1678; T. J. R. Hughes, The Finite Element "
            "Method, Dover 2000, ch. 2.7",
        .parameters = ElasticParameters(),
        .residual_when_missing =
            "Without any elasticity the body flows. If a nonlinear law is used instead, nothing is "
            "missing as long as rotations stay below a few degrees.",
        .separating_experiment =
            "Load in small steps: under the linear law displacements are proportional to the load "
            "at every amplitude, and the body swells when it rotates; a corotational body does "
            "neither",
        .look_alikes = {"corotational", "st_venant_kirchhoff", "neo_hookean", "strain_stiffening"},
        .conserves_momentum = true,
        // Torques balance about the rest positions only, because the law is not invariant under
        // rotations.
        .conserves_angular_momentum = false};
    return card;
  }

  explicit LinearLaw(const LameConstants& lame) : lame_(lame) {}

  double EnergyDensity(const Eigen::Matrix3d& F) const {
    const Eigen::Matrix3d strain = Strain(F);
    const double trace = strain.trace();
    return lame_.mu * strain.squaredNorm() + 0.5 * lame_.lambda * trace * trace;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F) const {
    Eigen::Matrix3d stress = Strain(F);
    const double trace = stress.trace();
    stress *= 2 * lame_.mu;
    stress.diagonal().array() += lame_.lambda * trace;
    return stress;
  }

  // The tangent is constant and positive semi-definite.
  StressTangent Tangent(const Eigen::Matrix3d& /*F*/, bool /*convexify*/) const {
    StressTangent tangent = StressTangent::Zero();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        tangent(i + 3 * j, i + 3 * j) += lame_.mu;
        tangent(i + 3 * j, j + 3 * i) += lame_.mu;
        tangent(4 * i, 4 * j) += lame_.lambda;
      }
    }
    return tangent;
  }

 private:
  static Eigen::Matrix3d Strain(const Eigen::Matrix3d& F) {
    return 0.5 * (F + F.transpose()) - Eigen::Matrix3d::Identity();
  }

  LameConstants lame_;
};

}  // namespace

const EffectCard& LinearElasticityCard() { return LinearLaw::Card(); }

CatalogueEntry LinearElasticity() {
  return {&LinearLaw::Card(), CatalogueEntry::Kind::kMaterial, &MakeAs<ElasticSolid<LinearLaw>>,
          &ReadParameters};
}

}  // namespace lacuna
