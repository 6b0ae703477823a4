// Corotational elasticity: Hooke's law in a frame that rotates with the material.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "effects/catalogue.h"
#include "effects/elastic_parameters.h"
#include "effects/standard_cards.h"
#include "fem/elastic_solid.h"

namespace lacuna {
namespace {

// The exact tangent in closed form. With F = V R (V symmetric), G = (tr V) I − V and w = G⁻¹ times
// the axial vector of δF Rᵀ − R δFᵀ, the rotation changes by δR = [w]× R, so that
//   δP = 2μ δF + λ (R : δF) R + c [w]× R,    c = λ tr(V − I) − 2μ,
// and with h_a = R g_a the stiffness blocks need no 9 × 9 matrix:
//   K_ab = 2μ (g_a · g_b) I + λ h_a h_bᵀ + [h_a]×ᵀ (c G⁻¹) [h_b]×.
struct CorotationalTangent {
  Eigen::Matrix3d rotation;
  Eigen::Matrix3d spin;  // c G⁻¹, symmetric
  LameConstants lame;
};

template <int kNodes>
void AddStiffness(const CorotationalTangent& tangent,
                  const Eigen::Matrix<double, kNodes, 3>& gradient, double scale,
                  ElementStiffness<kNodes>* stiffness) {
  const Eigen::Matrix<double, 3, kNodes> h = tangent.rotation.lazyProduct(gradient.transpose());
  const Eigen::Matrix3d spin = scale * tangent.spin;
  const double lambda = scale * tangent.lame.lambda;
  const double two_mu = 2 * scale * tangent.lame.mu;
  // turned[b] = spin [h_b]×, whose rows are (row of spin) × h_b
  Eigen::Matrix3d turned[kNodes];
  for (int b = 0; b < kNodes; ++b) {
    const double x = h(0, b), y = h(1, b), z = h(2, b);
    turned[b].col(0) = spin.col(1) * z - spin.col(2) * y;
    turned[b].col(1) = spin.col(2) * x - spin.col(0) * z;
    turned[b].col(2) = spin.col(0) * y - spin.col(1) * x;
  }
  for (int a = 0; a < kNodes; ++a) {
    const double x = h(0, a), y = h(1, a), z = h(2, a);
    for (int b = a; b < kNodes; ++b) {
      Eigen::Matrix3d block;
      const double diagonal = two_mu * h.col(a).dot(h.col(b));
      for (int k = 0; k < 3; ++k) {
        const Eigen::Matrix3d& t = turned[b];
        const double dilatation = lambda * h(k, b);
        block(0, k) = dilatation * x + (z * t(1, k) - y * t(2, k));
        block(1, k) = dilatation * y + (x * t(2, k) - z * t(0, k));
        block(2, k) = dilatation * z + (y * t(0, k) - x * t(1, k));
        block(k, k) += diagonal;
      }
      stiffness->Add(a, b, block);
    }
  }
}

class CorotationalLaw {
 public:
  static const EffectCard& Card() {
    static const EffectCard card{
        .type = "corotational",
        .family = EffectFamily::kElasticity,
        .title = "Corotational linear elasticity",
        .equation =
            "ψ = μ ‖F − R‖² + λ/2 (tr(RᵀF) − 3)²,  R the rotation nearest to F,  "
            "P = 2μ (F − R) + λ (tr(RᵀF) − 3) R",
        .citation =
            "M. Müller, M. Gross, Interactive Virtual Materials, Graphics Interface 2004; "
            "exact tangent and its definite approximation: A. McAdams et al., Efficient "
            "Elasticity for Character Skinning with Contact and Collisions, ACM TOG 30(4), "
            "2011",
        .parameters = ElasticParameters(),
        .residual_when_missing =
            "If a small-strain law is used instead, rotated parts of the body appear swollen, by 1 "
            "− cos of the angle.",
        .separating_experiment =
            "Bend or twist a slender part by more than 20°: linear elasticity swells, this law "
            "does not. Stretch by more than 20 %: the force of this law stays proportional to the "
            "elongation, that of a hyperelastic law does not",
        .look_alikes = {"linear", "st_venant_kirchhoff", "neo_hookean", "strain_stiffening"},
        .conserves_momentum = true,
        .conserves_angular_momentum = true};
    return card;
  }

  explicit CorotationalLaw(const LameConstants& lame) : lame_(lame) {}

  double EnergyDensity(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) const {
    const double trace = R.cwiseProduct(F).sum() - 3;
    return lame_.mu * (F - R).squaredNorm() + 0.5 * lame_.lambda * trace * trace;
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) const {
    const double trace = R.cwiseProduct(F).sum() - 3;
    return 2 * lame_.mu * F + (lame_.lambda * trace - 2 * lame_.mu) * R;
  }

  CorotationalTangent Tangent(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                              bool convexify) const {
    CorotationalTangent tangent;
    tangent.lame = lame_;
    tangent.rotation = R;
    Eigen::Matrix3d V = F.lazyProduct(R.transpose());
    V = (0.5 * (V + V.transpose())).eval();
    const double trace = V.trace();
    const double c = lame_.lambda * (trace - 3) - 2 * lame_.mu;
    Eigen::Matrix3d G = -V;
    G.diagonal().array() += trace;
    // On rotations δF = [a]× R / 2 the tangent is μ I + c G⁻¹: definite when G > −c/μ.
    const bool regular = IsPositive(G, kSmallestStretchSum);
    if (regular && (!convexify || c >= 0 || IsPositive(G, -c / lame_.mu))) {
      const Eigen::Matrix3d cofactor = Cofactor(G);
      tangent.spin = (c / G.col(0).dot(cofactor.col(0))) * cofactor;
      return tangent;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(G);
    Eigen::Vector3d spin = c * axes.eigenvalues().cwiseMax(kSmallestStretchSum).cwiseInverse();
    if (convexify) spin = spin.cwiseMax(-lame_.mu);
    tangent.spin = axes.eigenvectors() * spin.asDiagonal() * axes.eigenvectors().transpose();
    return tangent;
  }

 private:
  // Eigenvalues of G are sums of two principal stretches; at 0 (an inverted element with two equal
  // and opposite ones) the nearest rotation is not unique and the energy has a kink.
  static constexpr double kSmallestStretchSum = 1e-6;

  // A > bound·I, by leading minors.
  static bool IsPositive(const Eigen::Matrix3d& A, double bound) {
    const double a = A(0, 0) - bound, b = A(1, 1) - bound, c = A(2, 2) - bound;
    const double d = A(0, 1), e = A(1, 2), f = A(0, 2);
    return a > 0 && a * b - d * d > 0 &&
           a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f) > 0;
  }

  LameConstants lame_;
};

}  // namespace

const EffectCard& CorotationalElasticityCard() { return CorotationalLaw::Card(); }

CatalogueEntry CorotationalElasticity() {
  return {&CorotationalLaw::Card(), CatalogueEntry::Kind::kMaterial,
          &MakeAs<ElasticSolid<CorotationalLaw>>, &ReadParameters};
}

}  // namespace lacuna
