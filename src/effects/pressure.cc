// Pressure of a fluid on the surface, along the normal of the deformed surface.
//
// The nodal forces are f_a = −p ∫ N_a n dA over the deformed boundary faces, curved ones of
// quadratic elements included: with x = Σ N_b(ξ, η) x_b and the tangents t₁ = ∂x/∂ξ, t₂ = ∂x/∂η,
//   n dA = t₁ × t₂ dξ dη,
// a polynomial in ξ, η, which the quadrature integrates exactly (one point for a linear face, the
// six-point rule of degree 4 for a quadratic one; Cowper 1973). So the forces on a closed surface
// are exactly −p times the derivative of the enclosed volume V: there is an energy p V and their
// sum and moment vanish.
//
// With s_b = ∂N_b/∂η t₁ − ∂N_b/∂ξ t₂, d(t₁ × t₂) = Σ s_b × dx_b, and the symmetric part of the
// tangent has the blocks −½ p ∫ [N_a s_b − N_b s_a]× dξ dη. On a closed surface this is the whole
// tangent; on a part of it the skew-symmetric remainder belongs to the rim of the part. The tangent
// is indefinite, and small against the elastic stiffness while p is below the modulus; with
// `convexify` it is omitted.
#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "core/error.h"
#include "effects/catalogue.h"
#include "effects/rest_quantity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"
#include "geometry/face_shape_functions.h"

namespace lacuna {
namespace {

// A point of the quadrature over the coordinates 0 ≤ ξ, η, ξ + η ≤ 1 of a face.
template <int kNodes>
struct QuadraturePoint {
  double weight;  // sums to ½
  FaceShape<kNodes> shape;
};

QuadraturePoint<6> QuadraticPoint(double weight, double xi, double eta) {
  return {weight, QuadraticFaceShape({1 - xi - eta, xi, eta})};
}

template <int kNodes>
const auto& FaceRule() {
  if constexpr (kNodes == 3) {
    static const std::array<QuadraturePoint<3>, 1> rule{
        {{0.5, LinearFaceShape({1 - 1.0 / 3 - 1.0 / 3, 1.0 / 3, 1.0 / 3})}}};
    return rule;
  } else {
    static const std::array<QuadraturePoint<6>, 6> rule = [] {
      constexpr double kNear = 0.44594849091596489, kNearWeight = 0.22338158967801147 / 2;
      constexpr double kFar = 0.091576213509770743, kFarWeight = 0.10995174365532187 / 2;
      return std::array{QuadraticPoint(kNearWeight, kNear, kNear),
                        QuadraticPoint(kNearWeight, 1 - 2 * kNear, kNear),
                        QuadraticPoint(kNearWeight, kNear, 1 - 2 * kNear),
                        QuadraticPoint(kFarWeight, kFar, kFar),
                        QuadraticPoint(kFarWeight, 1 - 2 * kFar, kFar),
                        QuadraticPoint(kFarWeight, kFar, 1 - 2 * kFar)};
    }();
    return rule;
  }
}

// The faces under pressure.
struct PressedFaces {
  Eigen::MatrixXi nodes;   // 3 or 6 × faces
  std::vector<int> block;  // matrix block of nodes a, b of face f: entry (f·n + a)·n + b
  bool closed = false;     // whether the faces make up the whole boundary
};

// Calls visit(std::integral_constant<int, nodes per face>).
template <typename Visit>
auto WithNodesPerFace(const Body& body, const Visit& visit) {
  if (body.mesh.Order() == 1) return visit(std::integral_constant<int, 3>());
  return visit(std::integral_constant<int, 6>());
}

class PressureEffect final : public CloneableEffect<PressureEffect> {
 public:
  enum Parameter { kPressureValue, kPoint, kNormal = kPoint + 3 };
  static constexpr int kParameters = kNormal + 3;

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit PressureEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), kParameters);
    parameters_ = values;
    faces_.SetSettings(values.tail<kParameters - kPoint>());
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddScaledForce(at, parameters_[kPressureValue], force);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (convexify) return;
    const double scale = weights.position * parameters_[kPressureValue];
    AddStiffness<1>(at, scale, tangent);
  }

  // On a closed surface the pressure has a potential.
  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    const double scale = weights.position * parameters_[kPressureValue];
    if (scale == 0 || Faces(at.body)->closed) return false;
    AddStiffness<-1>(at, scale, tangent);
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, kPressureValue) << "the others are settings";
    AddScaledForce(at, 1, derivative);
  }

  // p (V − V at rest) if the pressure acts on all of the boundary; on a part there is no potential.
  std::optional<double> Energy(const Kinematics& at) const override {
    if (!Faces(at.body)->closed) return std::nullopt;
    const Eigen::VectorXd rest = at.body.mesh.nodes.reshaped();
    const double growth = WithNodesPerFace(at.body, [&](auto nodes) {
      constexpr int kNodes = decltype(nodes)::value;
      return Volume<kNodes>(at.body, at.position) - Volume<kNodes>(at.body, rest);
    });
    return parameters_[kPressureValue] * growth;
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "pressure",
        .family = EffectFamily::kVolumeStress,
        .title = "Pressure on the surface",
        .equation = "f_a = −p ∫ N_a n dA over the deformed surface, n outward",
        .citation =
            "H. D. Hibbitt, Some follower forces and load stiffness, Int. J. Numer. Methods Eng. "
            "14 (1979) 937–941; K. Schweizerhof & E. Ramm, Displacement dependent pressure loads "
            "in nonlinear finite element analyses, Computers & Structures 18 (1984) 1099–1114",
        .parameters = {{.name = "pressure",
                        .meaning = "p, positive where it presses on the surface from outside, "
                                   "negative for suction or for overpressure inside a thin shell",
                        .dimension = kPressure,
                        .bounds = kAnyValue,
                        .null_value = 0,
                        .plausible_min = -1e4,
                        .plausible_max = 1e4,
                        .of_body = true,
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "The residual is a force along the normal of the surface, proportional to area, which "
            "rotates with the surface. Under pressure from all sides the body shrinks or swells "
            "without moving, more so the further ν is from ½.",
        .separating_experiment =
            "Turn the body: pressure rotates with it, gravity does not. Vent the chamber: pressure "
            "vanishes at once, a wrong rest shape stays",
        .look_alikes = {"gravity", "follower_force", "swelling"},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendPointSetting("point", "a point of the plane that bounds the part under pressure,", &card);
    AppendDirectionSetting("normal",
                           "the pressure acts on the faces that at rest lie wholly on this side "
                           "of the plane; if omitted, on all faces;",
                           Eigen::Vector3d::Zero(), &card);
    return card;
  }

  std::shared_ptr<const PressedFaces> Faces(const Body& body) const {
    return faces_.Of(body, &ChooseFaces);
  }

  // `plane`: the point and the normal.
  static PressedFaces ChooseFaces(const Body& body, const Eigen::VectorXd& plane) {
    const Eigen::VectorXd inside = InHalfSpace(plane.head<3>(), plane.tail<3>(), body);
    const Eigen::MatrixXi& all = body.boundary.faces;
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index f = 0; f < all.cols(); ++f) {
      if (inside(all.col(f)).minCoeff() > 0) chosen.push_back(f);
    }
    if (chosen.empty()) {
      throw InputError(
          "effect pressure: no face of the body's surface lies wholly on the side of its plane "
          "that `point` and `normal` name");
    }
    PressedFaces faces;
    faces.nodes = all(Eigen::all, chosen);
    faces.closed = faces.nodes.cols() == all.cols();
    faces.block.reserve(faces.nodes.size() * faces.nodes.rows());
    for (const auto& face : faces.nodes.colwise()) {
      for (const int a : face) {
        for (const int b : face) faces.block.push_back(body.pattern->Find(a, b));
      }
    }
    return faces;
  }

  // Calls visit(face, point, x, t₁, t₂) with the nodes' positions x (3 × nodes of the face).
  template <int kNodes, typename Visit>
  static void ForEachPoint(const PressedFaces& faces, const Eigen::VectorXd& position,
                           const Visit& visit) {
    Eigen::Matrix<double, 3, kNodes> x;
    for (Eigen::Index f = 0; f < faces.nodes.cols(); ++f) {
      for (int a = 0; a < kNodes; ++a) x.col(a) = position.segment<3>(3 * faces.nodes(a, f));
      // Differences keep the tangents exact far from the origin.
      const Eigen::Matrix<double, 3, kNodes> edges = x.colwise() - Eigen::Vector3d(x.col(0));
      for (const QuadraturePoint<kNodes>& point : FaceRule<kNodes>()) {
        visit(f, point, x, Eigen::Vector3d(edges * point.shape.by_first),
              Eigen::Vector3d(edges * point.shape.by_second));
      }
    }
  }

  void AddScaledForce(const Kinematics& at, double pressure, Eigen::VectorXd* force) const {
    WithNodesPerFace(at.body,
                     [&](auto nodes) { AddLoad<decltype(nodes)::value>(at, pressure, force); });
  }

  template <int kNodes>
  void AddLoad(const Kinematics& at, double pressure, Eigen::VectorXd* force) const {
    const auto faces = Faces(at.body);
    ForEachPoint<kNodes>(
        *faces, at.position,
        [&](Eigen::Index f, const QuadraturePoint<kNodes>& point, const auto& /*x*/,
            const Eigen::Vector3d& t1, const Eigen::Vector3d& t2) {
          const Eigen::Vector3d load = -pressure * point.weight * t1.cross(t2);
          for (int a = 0; a < kNodes; ++a) {
            force->segment<3>(3 * faces->nodes(a, f)) += point.shape.value[a] * load;
          }
        });
  }

  // The symmetric part of the tangent, or with kMirror = −1 the skew-symmetric one.
  template <int kMirror>
  void AddStiffness(const Kinematics& at, double scale, BlockMatrix* tangent) const {
    WithNodesPerFace(at.body, [&](auto nodes) {
      AddStiffness<kMirror, decltype(nodes)::value>(at, scale, tangent);
    });
  }

  template <int kMirror, int kNodes>
  void AddStiffness(const Kinematics& at, double scale, BlockMatrix* tangent) const {
    const auto faces = Faces(at.body);
    ForEachPoint<kNodes>(
        *faces, at.position,
        [&](Eigen::Index f, const QuadraturePoint<kNodes>& point, const auto& /*x*/,
            const Eigen::Vector3d& t1, const Eigen::Vector3d& t2) {
          const Eigen::Matrix<double, 3, kNodes> s =
              t1 * point.shape.by_second.transpose() - t2 * point.shape.by_first.transpose();
          const int* block = &faces->block[f * kNodes * kNodes];
          for (int a = 0; a < kNodes; ++a) {
            for (int b = 0; b < kNodes; ++b) {
              const Eigen::Vector3d c =
                  -0.5 * scale * point.weight *
                  (point.shape.value[a] * s.col(b) - kMirror * point.shape.value[b] * s.col(a));
              Eigen::Matrix3d cross;
              cross << 0, -c[2], c[1], c[2], 0, -c[0], -c[1], c[0], 0;
              tangent->Block(block[a * kNodes + b]) += cross;
            }
          }
        });
  }

  // The volume enclosed by the surface, ⅓ ∫ (x − a) · n dA, with a point a nearby.
  template <int kNodes>
  double Volume(const Body& body, const Eigen::VectorXd& position) const {
    const Eigen::Vector3d apex = position.head<3>();
    double volume = 0;
    ForEachPoint<kNodes>(*Faces(body), position,
                         [&](Eigen::Index /*f*/, const QuadraturePoint<kNodes>& point,
                             const auto& x, const Eigen::Vector3d& t1, const Eigen::Vector3d& t2) {
                           volume +=
                               point.weight / 3 * (x * point.shape.value - apex).dot(t1.cross(t2));
                         });
    return volume;
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  RestQuantity<PressedFaces> faces_;
};

}  // namespace

CatalogueEntry Pressure() {
  return {&PressureEffect::TheCard(), CatalogueEntry::Kind::kEffect, &MakeAs<PressureEffect>,
          &ReadParameters};
}

}  // namespace lacuna
