// The St. Venant–Kirchhoff law: Hooke's law between Green–Lagrange strain and its work conjugate.
#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/standard_cards.h"
#include "fem/elastic_solid.h"

namespace lacuna {
namespace {

class SaintVenantKirchhoffLaw {
 public:
  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "st_venant_kirchhoff",
        .family = EffectFamily::kElasticity,
        .title = "St. Venant–Kirchhoff elasticity",
        .equation = "ψ = μ E:E + λ/2 (tr E)²,  E = ½ (FᵀF − I),  P = F (2μ E + λ (tr E) I)",
        .citation = "G. A. Holzapfel, Nonlinear Solid Mechanics, Wiley 2000, sec. 6.5, Eq. 6.151",
        .parameters = ElasticParameters(),
        .residual_when_missing =
            "Measured tension stiffens more, and compression less, than the fitted law predicts; "
            "in compression the body softens and finally collapses at about 58 % of its length.",
        .separating_experiment =
            "Stretch and compress by more than 20 %: only this law stiffens in tension and softens "
            "in compression. In bending of thin parts it cannot be distinguished from the "
            "corotational law",
        .look_alikes = {"linear", "corotational", "neo_hookean", "strain_stiffening"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    return card;
  }

  explicit SaintVenantKirchhoffLaw(const LameConstants& lame) : lame_(lame) {}

  double EnergyDensity(const Eigen::Matrix3d& F) const {
    const Eigen::Matrix3d strain = Strain(F);
    const double trace = strain.trace();
    return lame_.mu * strain.squaredNorm() + 0.5 * lame_.lambda * trace * trace;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F) const { return F.lazyProduct(SecondStress(F)); }

  StressTangent Tangent(const Eigen::Matrix3d& F, bool convexify) const {
    // δP = δF S + μ (F Fᵀ δF + F δFᵀ F) + λ F (F : δF)
    const Eigen::Matrix3d S = SecondStress(F);
    const Eigen::Matrix3d B = lame_.mu * F * F.transpose();
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> f(F.data());
    StressTangent tangent = lame_.lambda * f * f.transpose();
    for (int l = 0; l < 3; ++l) {
      for (int j = 0; j < 3; ++j) {
        auto block = tangent.block<3, 3>(3 * j, 3 * l);
        block.noalias() += lame_.mu * F.col(l) * F.col(j).transpose();
        block.diagonal().array() += S(l, j);
        if (l == j) block += B;
      }
    }
    if (!convexify || IsPositiveSemidefinite(tangent)) return tangent;
    return Projected(F);
  }

 private:
  static Eigen::Matrix3d Strain(const Eigen::Matrix3d& F) {
    return 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
  }

  Eigen::Matrix3d SecondStress(const Eigen::Matrix3d& F) const {
    Eigen::Matrix3d stress = Strain(F);
    const double trace = stress.trace();
    stress *= 2 * lame_.mu;
    stress.diagonal().array() += lame_.lambda * trace;
    return stress;
  }

  // ψ_i = μ s_i (s_i² − 1) + p s_i with p = λ/2 (Σ s² − 3).
  StressTangent Projected(const Eigen::Matrix3d& F) const {
    const SignedSvd axes = ComputeSignedSvd(F);
    const Eigen::Vector3d& s = axes.stretch;
    const double p = 0.5 * lame_.lambda * (s.squaredNorm() - 3);
    PrincipalTangent principal;
    principal.stretch = lame_.lambda * s * s.transpose();
    for (int k = 0; k < 3; ++k) {
      const double si = s[(k + 1) % 3];
      const double sj = s[(k + 2) % 3];
      principal.stretch(k, k) += lame_.mu * (3 * s[k] * s[k] - 1) + p;
      principal.twist[k] = lame_.mu * (si * si - si * sj + sj * sj - 1) + p;
      principal.flip[k] = lame_.mu * (si * si + si * sj + sj * sj - 1) + p;
    }
    return ProjectedTangent(axes, principal);
  }

  LameConstants lame_;
};

}  // namespace

const EffectCard& SaintVenantKirchhoffCard() { return SaintVenantKirchhoffLaw::Card(); }

CatalogueEntry SaintVenantKirchhoff() {
  return {&SaintVenantKirchhoffLaw::Card(), CatalogueEntry::Kind::kMaterial,
          &MakeAs<ElasticSolid<SaintVenantKirchhoffLaw>>, &ReadParameters};
}

}  // namespace lacuna
