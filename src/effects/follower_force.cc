// A force that rotates with the body at its place, such as the thrust of a nozzle, the pull of a
// tendon or the push of a tool that is glued on.
//
// A force density R F, spread as exp(−|X − c|²/(2 r²)) about the place c at rest over the volume, R
// the rotation nearest to the deformation gradient of each quadrature point:
//   f_a = Σ_q s_q N_a R_q F,   Σ s_q = 1,
// so that the force rotates with a rigid rotation of the body. Near the surface the distribution is
// cut off, which moves the centre of the force inwards by less than r.
//
// With w = G⁻¹ axial(δF Rᵀ − R δFᵀ), G = (tr V) I − V, F = V R the gradient, δR = [w]× R, so that
// with h_b = R g_b and the rotated force t = R F
//   ∂f_a/∂x_b = −Σ_q s_q N_a [t]× G⁻¹ [h_b]×.
// The force has no potential, and its tangent is neither symmetric nor definite; with `convexify`
// it is omitted. G is singular where the sum of two principal stretches vanishes, which requires an
// inverted element; R is discontinuous there, and the tangent limits the eigenvalues of G to at
// least 0.01.
#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <vector>

#include "effects/catalogue.h"
#include "effects/rest_quantity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"
#include "fem/element_kinematics.h"
#include "fem/polar_decomposition.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

// N_a at the quadrature points of an element (nodes × points).
Eigen::MatrixXd ShapesAtPoints(int order) {
  const TetQuadrature rule = ElementQuadrature(order);
  Eigen::MatrixXd shapes(order == 1 ? 4 : 10, rule.points.cols());
  for (Eigen::Index p = 0; p < rule.points.cols(); ++p) {
    shapes.col(p) = ShapeValues(order, rule.points.col(p));
  }
  return shapes;
}

Eigen::Matrix3d CrossProduct(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return cross;
}

// G⁻¹ for a deformation gradient and its rotation.
Eigen::Matrix3d InverseSpinStiffness(const Eigen::Matrix3d& gradient,
                                     const Eigen::Matrix3d& rotation) {
  constexpr double kSmallest = 0.01;
  const Eigen::Matrix3d V = gradient * rotation.transpose();
  const Eigen::Matrix3d G = V.trace() * Eigen::Matrix3d::Identity() - 0.5 * (V + V.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(G);
  const Eigen::Vector3d inverse = eigen.eigenvalues().cwiseMax(kSmallest).cwiseInverse();
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

class FollowerForceEffect final : public CloneableEffect<FollowerForceEffect> {
 public:
  enum Parameter { kForceValue, kCentre = kForceValue + 3, kRadius = kCentre + 3 };
  static constexpr int kParameters = kRadius + 1;

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit FollowerForceEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), kParameters);
    parameters_ = values;
    spread_.SetSettings(values.tail<4>());
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    const auto spread = GetSpread(at.body);
    AddTurned(at, *spread, spread->share, parameters_.head<3>(), force);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (!convexify && weights.position != 0) AddStiffness<1>(at, weights.position, tangent);
  }

  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    if (weights.position == 0 || parameters_.head<3>().isZero(0)) return false;
    AddStiffness<-1>(at, weights.position, tangent);
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < kRadius) << "the others are settings";
    const auto spread = GetSpread(at.body);
    if (parameter < kCentre) {
      AddTurned(at, *spread, spread->share, Eigen::Vector3d::Unit(parameter), derivative);
    } else {
      AddTurned(at, *spread,
                BumpShareDerivatives(parameter - kCentre, parameters_[kRadius], at.body.point,
                                     spread->share),
                parameters_.head<3>(), derivative);
    }
  }

 private:
  struct Spread {
    Eigen::MatrixXd shape;   // N_a at the points of an element (nodes × points)
    Eigen::VectorXd share;   // s_q
    std::vector<char> felt;  // elements: whether any of their points has a share
  };

  static EffectCard MakeCard() {
    EffectCard card{
        .type = "follower_force",
        .family = EffectFamily::kSteadyForce,
        .title = "Force that turns with the body",
        .equation =
            "f_a = Σ_q s_q N_a R_q F,  R the rotation nearest to ∂x/∂X,  "
            "s_q ∝ V_q exp(−|X_q − c|²/(2 r²)),  Σ s_q = 1",
        .citation =
            "V. V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability, Pergamon "
            "1963; M. Beck, Z. angew. Math. Phys. 3 (1952) 225–228",
        .parameters = {},
        .residual_when_missing =
            "The residual is a force at one place that keeps its magnitude and rotates as the "
            "place rotates. If the model has a force of fixed direction instead, the residual "
            "grows with the rotation there.",
        .separating_experiment =
            "Bend the body far: a force of fixed direction keeps its direction, a follower force "
            "rotates with the surface. At small rotations the two are the same",
        .look_alikes = {"point_force", "pressure"},
        .tried_at = TriedAtPlaces{{0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}, 0.1},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendVector({.name = "force",
                  .meaning = "the force as it is on the body at rest, F,",
                  .dimension = kForce,
                  .null_value = 0,
                  .plausible_min = -5,
                  .plausible_max = 5,
                  .of_body = true},
                 Eigen::Vector3d::Constant(kMustBeGiven), &card);
    AppendPlace("the place on the body at rest where it acts,", &card);
    return card;
  }

  // `place`: the centre and the radius.
  static Spread MakeSpread(const Body& body, const Eigen::VectorXd& place) {
    Spread spread;
    spread.shape = ShapesAtPoints(body.mesh.Order());
    spread.share = BumpShares(place.head<3>(), place[3], body.point, body.weight);
    spread.felt.assign(body.ElementCount(), 0);
    for (int q = 0; q < body.PointCount(); ++q) {
      if (spread.share[q] > 0) spread.felt[q / body.points_per_element] = 1;
    }
    return spread;
  }

  // Calls visit(element, q, N at q (nodes), ∂x/∂X) for all points with a share.
  template <int kNodes, typename Visit>
  void ForEachPoint(const Kinematics& at, const Spread& spread, const Visit& visit) const {
    constexpr int kPoints = QuadraturePoints<kNodes>();
    ForEachElement(*at.body.schedule, [&](int e) {
      if (!spread.felt[e]) return;
      Eigen::Matrix3d F[kPoints];
      FieldGradients<kNodes>(at.body, e, at.position, F);
      for (int p = 0; p < kPoints; ++p) {
        const int q = e * kPoints + p;
        if (spread.share[q] == 0) continue;
        const Eigen::Vector<double, kNodes> shape = spread.shape.col(p);
        visit(e, q, shape, F[p]);
      }
    });
  }

  // Σ_q share_q N_a R_q F
  void AddTurned(const Kinematics& at, const Spread& spread, const Eigen::VectorXd& share,
                 const Eigen::Vector3d& at_rest, Eigen::VectorXd* force) const {
    WithNodesPerElement(at.body, [&](auto nodes) {
      AddTurned<decltype(nodes)::value>(at, spread, share, at_rest, force);
    });
  }

  template <int kNodes>
  void AddTurned(const Kinematics& at, const Spread& spread, const Eigen::VectorXd& share,
                 const Eigen::Vector3d& at_rest, Eigen::VectorXd* force) const {
    ForEachPoint<kNodes>(
        at, spread,
        [&](int e, int q, const Eigen::Vector<double, kNodes>& shape, const Eigen::Matrix3d& F) {
          const Eigen::Vector3d turned = share[q] * (PolarRotation(F) * at_rest);
          for (int a = 0; a < kNodes; ++a)
            force->segment<3>(3 * at.body.mesh.tets(a, e)) += shape[a] * turned;
        });
  }

  // The symmetric part of the tangent, or with kMirror = −1 the skew-symmetric one.
  template <int kMirror>
  void AddStiffness(const Kinematics& at, double scale, BlockMatrix* tangent) const {
    WithNodesPerElement(at.body, [&](auto nodes) {
      AddStiffness<kMirror, decltype(nodes)::value>(at, scale, tangent);
    });
  }

  template <int kMirror, int kNodes>
  void AddStiffness(const Kinematics& at, double scale, BlockMatrix* tangent) const {
    const auto spread = GetSpread(at.body);
    const Eigen::Vector3d at_rest = parameters_.head<3>();
    ForEachPoint<kNodes>(
        at, *spread,
        [&](int e, int q, const Eigen::Vector<double, kNodes>& shape, const Eigen::Matrix3d& F) {
          const Eigen::Matrix3d rotation = PolarRotation(F);
          const Eigen::Matrix3d turn = -0.5 * scale * spread->share[q] *
                                       CrossProduct(rotation * at_rest) *
                                       InverseSpinStiffness(F, rotation);
          const Eigen::Matrix<double, 3, kNodes> h =
              rotation * ShapeGradient<kNodes>(at.body, q).transpose();
          std::array<Eigen::Matrix3d, kNodes> by_node;  // half of ∂(s t)/∂x_b
          for (int b = 0; b < kNodes; ++b) by_node[b] = turn * CrossProduct(h.col(b));
          ElementStiffness<kNodes> stiffness;
          stiffness.SetZero();
          for (int a = 0; a < kNodes; ++a) {
            for (int b = a; b < kNodes; ++b) {
              stiffness.Add(a, b,
                            shape[a] * by_node[b] + kMirror * shape[b] * by_node[a].transpose());
            }
          }
          ScatterStiffness<kNodes, kMirror>(at.body, e, stiffness, tangent);
        });
  }

  std::shared_ptr<const Spread> GetSpread(const Body& body) const {
    return spread_.Of(body, &MakeSpread);
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  RestQuantity<Spread> spread_;
};

}  // namespace

CatalogueEntry FollowerForce() {
  return {&FollowerForceEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<FollowerForceEffect>, &ReadParameters};
}

}  // namespace lacuna
