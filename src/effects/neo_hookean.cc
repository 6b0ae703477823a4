// A compressible neo-Hookean solid whose energy is a polynomial of F, hence finite and smooth for
// flattened and inverted elements too.
//
// The volumetric part is that of Smith, de Goes & Kim 2018 ("Stable neo-Hookean flesh simulation",
// Eq. 13), with the rest state at J = 1 and the constants chosen so that λ and μ are the Lamé
// constants at small strain. Their extra term log(I_C + 1) is left out: it removes a shallow local
// minimum at F = 0 (all nodes of an element in one point) but makes the shear stiffness grow with
// stretch (4/3 of μ in the limit), so that the law would not be neo-Hookean: at twice the length of
// an incompressible bar it is 11 % too stiff.
#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "fem/elastic_solid.h"

namespace lacuna {
namespace {

class NeoHookeanLaw {
 public:
  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "neo_hookean",
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
            "measured tension softens more (about as 1/length²) than the fitted law says, and "
            "large compression is far stiffer",
        .separating_experiment =
            "stretch by more than 30 %: a rubber's force falls below the "
            "straight line, St. Venant–Kirchhoff's rises above it; squeeze to "
            "half: only this law resists without buckling of elements",
        .look_alikes = {"corotational", "st_venant_kirchhoff"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    return card;
  }

  explicit NeoHookeanLaw(const LameConstants& lame) : lame_(lame) {}

  double EnergyDensity(const Eigen::Matrix3d& F) const {
    // F:F − 3 − 2 (J − 1) in terms of H = F − I, without the cancellation near the rest shape.
    const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
    const double trace = H.trace();
    const double second = 0.5 * (trace * trace - (H * H).trace());
    const double dilatation = trace + second + H.determinant();
    const double isochoric = H.squaredNorm() - 2 * (second + H.determinant());
    return 0.5 * lame_.mu * isochoric + 0.5 * (lame_.lambda + lame_.mu) * dilatation * dilatation;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F) const {
    const Eigen::Matrix3d cofactor = Cofactor(F);
    return lame_.mu * F + VolumetricSlope(F.col(0).dot(cofactor.col(0))) * cofactor;
  }

  StressTangent Tangent(const Eigen::Matrix3d& F, bool convexify) const {
    const Eigen::Matrix3d cofactor = Cofactor(F);
    const double slope = VolumetricSlope(F.col(0).dot(cofactor.col(0)));
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> c(cofactor.data());
    StressTangent tangent = (lame_.lambda + lame_.mu) * c * c.transpose();
    tangent.diagonal().array() += lame_.mu;
    // ∂²J/∂F²: column j of the cofactor is the cross product of the two other columns of F.
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3;
      const int l = (j + 2) % 3;
      AddCross(-slope * F.col(l), tangent.block<3, 3>(3 * j, 3 * k));
      AddCross(slope * F.col(k), tangent.block<3, 3>(3 * j, 3 * l));
    }
    if (!convexify || IsPositiveSemidefinite(tangent)) return tangent;
    return Projected(F);
  }

 private:
  // ∂ψ/∂J at fixed F:F.
  double VolumetricSlope(double J) const { return (lame_.lambda + lame_.mu) * (J - 1) - lame_.mu; }

  // block += [v]×
  template <typename Block>
  static void AddCross(const Eigen::Vector3d& v, Block block) {
    block(0, 1) -= v.z();
    block(0, 2) += v.y();
    block(1, 0) += v.z();
    block(1, 2) -= v.x();
    block(2, 0) -= v.y();
    block(2, 1) += v.x();
  }

  StressTangent Projected(const Eigen::Matrix3d& F) const {
    const SignedSvd axes = ComputeSignedSvd(F);
    const Eigen::Vector3d& s = axes.stretch;
    const double slope = VolumetricSlope(s.prod());
    PrincipalTangent principal;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3;
      const int j = (k + 2) % 3;
      const double bulk = lame_.lambda + lame_.mu;
      principal.stretch(k, k) = lame_.mu + bulk * s[i] * s[j] * s[i] * s[j];
      principal.stretch(i, j) = principal.stretch(j, i) =
          bulk * s[j] * s[k] * s[i] * s[k] + slope * s[k];
      principal.twist[k] = lame_.mu + slope * s[k];
      principal.flip[k] = lame_.mu - slope * s[k];
    }
    return ProjectedTangent(axes, principal);
  }

  LameConstants lame_;
};

}  // namespace

CatalogueEntry NeoHookean() {
  return {&NeoHookeanLaw::Card(), CatalogueEntry::Kind::kMaterial,
          [](const Eigen::VectorXd& parameters) -> std::shared_ptr<Effect> {
            return std::make_shared<ElasticSolid<NeoHookeanLaw>>(parameters);
          },
          &ReadParameters};
}

}  // namespace lacuna
