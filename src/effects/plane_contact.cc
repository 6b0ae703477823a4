#include "effects/plane_contact.h"

#include <glog/logging.h>

#include <cmath>
#include <vector>

#include "effects/catalogue.h"
#include "effects/contact_points.h"
#include "effects/rest_quantity.h"
#include "effects/vector_parameters.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

// Pa/m: a pressure per depth.
constexpr Dimension kPressurePerDepth{-2, 1, -2, 0, 0, "a pressure per depth", "100 MPa/m", "Pa/m"};

// The pressure at a depth ≥ 0 and what belongs to it, all for k = 1.
struct Penalty {
  double potential;  // ∫ p dd
  double pressure;   // p
  double slope;      // ∂p/∂d
};

Penalty PenaltyAt(double depth, double smoothing) {
  const double d = depth, s = smoothing;
  if (d <= s) return {d * d * d / (6 * s), d * d / (2 * s), d / s};
  const double linear = d - s / 2;
  return {linear * linear / 2 + s * s / 24, linear, 1};
}

// Contact with a half-space at rest, such as a floor: it pushes but never pulls, and may have
// friction.
//
// Penalty. A boundary point at depth d = c − n·x below the plane n·x = c is under the pressure
//   p(d) = k d²/(2s)  for 0 ≤ d ≤ s,   k (d − s/2)  beyond,   0 above the plane.
// It grows from zero with a continuous slope, so that Newton's method solves one smooth equation
// whichever nodes touch. Unlike that of a cubic potential, its slope stays below k, so that the
// tangent is as well conditioned in a hard impact as at rest. Nothing acts above the plane. k is a
// pressure per depth, so the law is independent of the mesh. The penetration under a pressure P is
// P/k + s/2 (√(2 s P/k) while that is below s); a suitable k is about 10 E / (element size).
//
// The pressure acts at points i of the boundary with areas A_i at rest (contact_points.h): the
// nodes of linear elements, and points within the faces of quadratic ones, from where the shape
// functions distribute it to the nodes. There is then a potential, E = Σ A_i ∫ p. A node on a sharp
// edge also carries a share of the other face, so that it is stiffer than the law; this error
// decreases as the mesh is refined. A corner of a quadratic element may be below the plane by a
// part of the element size before the first point of its faces is.
//
// Coulomb friction (optional), in the slip velocity u = (I − n nᵀ) v, regularised by a velocity w:
//   traction = −μ p u/√(|u|² + w²),
// the gradient of the convex dissipation μ p √(|u|² + w²), hence smooth and never a source of
// energy. A body that should stick under a tangential force of r times the limit creeps at
// w r/√(1 − r²); one that slides at |u| ≫ w lacks 1/2 (w/|u|)² of the limit. In the equilibrium
// before a motion there is no velocity and hence no friction; in a quasi-static motion v is the
// mean over the step, (x − xₙ)/h. p is taken at the end of the step, not at its start, so that it
// is exact for long steps and at the first touch. As a consequence, ∂f/∂x = A p′ (−n + μ u/√…) nᵀ
// is not symmetric; AddTangents adds its symmetric part, or with `convexify` −A p′ n nᵀ, with which
// the normal problem is solved exactly and the tangential one converges after it.
class PlaneContactEffect final : public CloneableEffect<PlaneContactEffect> {
 public:
  enum Parameter { kStiffness, kNormal, kOffset = kNormal + 3, kFriction, kSlip, kSmoothing };
  static constexpr int kParameters = kSmoothing + 1;

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit PlaneContactEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), kParameters);
    CHECK_GT(values.segment<3>(kNormal).norm(), 0) << "a plane needs a normal";
    CHECK_GT(values[kSlip], 0);
    CHECK_GT(values[kSmoothing], 0);
    parameters_ = values;
    normal_ = values.segment<3>(kNormal).normalized();
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    ForEachContact(at, [&](const Contact& contact) {
      Distribute(contact.point,
                 contact.point.area * Stiffness() * contact.penalty.pressure * Direction(contact),
                 force);
    });
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    const Eigen::Matrix3d tangential = Eigen::Matrix3d::Identity() - normal_ * normal_.transpose();
    ForEachContact(at, [&](const Contact& contact) {
      const double scale = contact.point.area * Stiffness();
      const Eigen::Vector3d direction = convexify ? normal_ : Direction(contact);
      Eigen::Matrix3d block = -0.5 * weights.position * scale * contact.penalty.slope *
                              (direction * normal_.transpose() + normal_ * direction.transpose());
      block -= weights.velocity * scale * contact.penalty.pressure * Friction() *
               SlipDerivative(contact, tangential);
      AddBlocks(contact.point, block, tangent);
    });
  }

  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    if (Friction() == 0 || weights.position == 0) return false;
    ForEachContact(at, [&](const Contact& contact) {
      const Eigen::Vector3d direction = Direction(contact);
      AddBlocks(contact.point,
                -0.5 * weights.position * contact.point.area * Stiffness() * contact.penalty.slope *
                    (direction * normal_.transpose() - normal_ * direction.transpose()),
                tangent);
    });
    return true;
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < kSlip);
    ForEachContact(at, [&](const Contact& contact) {
      Distribute(contact.point, contact.point.area * TractionDerivative(at, contact, parameter),
                 derivative);
    });
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    if (Friction() != 0) return std::nullopt;
    double energy = 0;
    ForEachContact(at, [&](const Contact& contact) {
      energy += contact.point.area * Stiffness() * contact.penalty.potential;
    });
    return energy;
  }

 private:
  // A point of the boundary below the plane.
  struct Contact {
    const ContactPoint& point;
    Penalty penalty;       // penalty at the depth of the point
    Eigen::Vector3d slip;  // u, m/s
    double slip_norm;      // √(|u|² + w²), m/s
  };

  static EffectCard MakeCard() {
    EffectCard card{
        .type = "plane_contact",
        .family = EffectFamily::kContact,
        .title = "Contact with a plane, with Coulomb friction",
        .equation =
            "f_i = A_i p(d_i) (n − μ u_i/√(|u_i|² + w²)),  d = c − n·x,  u = (I − n nᵀ) v;  "
            "p = k d²/(2s) for 0 ≤ d ≤ s, k (d − s/2) for d > s, else 0",
        .citation =
            "P. Wriggers, Computational Contact Mechanics, 2nd ed., Springer 2006, ch. 5 (penalty "
            "method, regularised Coulomb law); C. A. de Coulomb, Théorie des machines simples, "
            "1785",
        .parameters = {},
        .residual_when_missing =
            "The residual is a push in one fixed direction, on the lowest boundary nodes only, "
            "that begins at touch-down and ends at lift-off; without it the body sinks through the "
            "plane. If the model has contact without friction, it is a force within the touching "
            "surface, against the slip.",
        .separating_experiment =
            "Lift the body off the plane: contact ends at once, gravity and damping stay. For "
            "friction, push the body at two speeds: Coulomb friction stays the same, "
            "mass-proportional damping doubles, and only friction grows with a weight placed on "
            "top",
        .look_alikes = {"gravity", "mass_damping", "elastic_support", "slipping_support"},
        .tried_at = TriedAtContactPlanes{},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    card.parameters.push_back({.name = "stiffness",
                               .meaning = "pressure per depth of penetration, k",
                               .dimension = kPressurePerDepth,
                               .bounds = kNotNegative,
                               .null_value = 0,
                               .plausible_min = 1e6,
                               .plausible_max = 1e10,
                               .default_value = kMustBeGiven,
                               .log_scale = true});
    AppendVector({.name = "normal",
                  .meaning = "direction away from the half-space, of any length,",
                  .dimension = kDimensionless,
                  .null_value = kNoNullValue,
                  .plausible_min = -1,
                  .plausible_max = 1},
                 Eigen::Vector3d::UnitZ(), &card);
    card.parameters.push_back({.name = "offset",
                               .meaning = "height of the plane along its unit normal, c = n·x",
                               .dimension = kLength,
                               .bounds = kAnyValue,
                               .null_value = kNoNullValue,
                               .plausible_min = -1,
                               .plausible_max = 1,
                               .default_value = 0,
                               .log_scale = false});
    AppendContactLaw(&card);
    return card;
  }

  // Appends the friction and the two regularisations of the contact law.
  static void AppendContactLaw(EffectCard* card) {
    card->parameters.push_back({.name = "friction",
                                .meaning = "coefficient of friction, μ",
                                .dimension = kDimensionless,
                                .bounds = kNotNegative,
                                .null_value = 0,
                                .plausible_min = 0,
                                .plausible_max = 1.5,
                                .default_value = 0,
                                .log_scale = false});
    card->parameters.push_back({.name = "slip_velocity",
                                .meaning = "slip at which friction reaches 71 % of its limit, w",
                                .dimension = kVelocity,
                                .bounds = kPositive,
                                .null_value = kNoNullValue,
                                .plausible_min = 1e-5,
                                .plausible_max = 1e-2,
                                .default_value = 1e-3,
                                .log_scale = true,
                                .setting = true});
    card->parameters.push_back({.name = "smoothing",
                                .meaning = "depth over which the push becomes proportional, s",
                                .dimension = kLength,
                                .bounds = kPositive,
                                .null_value = kNoNullValue,
                                .plausible_min = 1e-6,
                                .plausible_max = 1e-3,
                                .default_value = 1e-4,
                                .log_scale = true,
                                .setting = true});
  }

  double Stiffness() const { return parameters_[kStiffness]; }
  double Friction() const { return parameters_[kFriction]; }

  template <typename Visit>
  void ForEachContact(const Kinematics& at, const Visit& visit) const {
    const auto points = points_.Of(
        at.body, [](const Body& body, const Eigen::VectorXd&) { return ContactPoints(body); });
    for (const ContactPoint& point : *points) {
      const double depth = parameters_[kOffset] - normal_.dot(point.At(at.position));
      if (depth <= 0) continue;
      const Eigen::Vector3d velocity = point.At(at.velocity);
      const Eigen::Vector3d slip = velocity - normal_.dot(velocity) * normal_;
      visit(Contact{point, PenaltyAt(depth, parameters_[kSmoothing]), slip,
                    std::hypot(slip.norm(), parameters_[kSlip])});
    }
  }

  // Adds a force at the point to those of its nodes.
  static void Distribute(const ContactPoint& point, const Eigen::Vector3d& at_point,
                         Eigen::VectorXd* force) {
    for (int a = 0; a < point.count; ++a)
      force->segment<3>(3 * point.node[static_cast<size_t>(a)]) += point.weight[a] * at_point;
  }

  // Adds the derivative of a force at the point by the place of the point.
  static void AddBlocks(const ContactPoint& point, const Eigen::Matrix3d& at_point,
                        BlockMatrix* tangent) {
    for (int a = 0; a < point.count; ++a)
      for (int b = 0; b < point.count; ++b) {
        const int block = tangent->pattern().Find(point.node[static_cast<size_t>(a)],
                                                  point.node[static_cast<size_t>(b)]);
        tangent->Block(block) += point.weight[a] * point.weight[b] * at_point;
      }
  }

  // The traction divided by the pressure.
  Eigen::Vector3d Direction(const Contact& contact) const {
    return normal_ - Friction() * contact.slip / contact.slip_norm;
  }

  // The change of u/√(|u|² + w²) with changes of u (columns).
  template <typename Changes>
  static Changes SlipDerivative(const Contact& contact, const Changes& changes) {
    const Eigen::Vector3d direction = contact.slip / contact.slip_norm;
    return (changes - direction * (direction.transpose() * changes)) / contact.slip_norm;
  }

  Eigen::Vector3d TractionDerivative(const Kinematics& at, const Contact& contact,
                                     int parameter) const {
    const Penalty& penalty = contact.penalty;
    const double pressure = Stiffness() * penalty.pressure;
    const double slope = Stiffness() * penalty.slope;
    switch (parameter) {
      case kStiffness:
        return penalty.pressure * Direction(contact);
      case kOffset:
        return slope * Direction(contact);
      case kFriction:
        return -pressure * contact.slip / contact.slip_norm;
      default:
        break;
    }
    const Eigen::Vector3d turn =
        (Eigen::Vector3d::Unit(parameter - kNormal) - normal_[parameter - kNormal] * normal_) /
        parameters_.segment<3>(kNormal).norm();
    const Eigen::Vector3d position = contact.point.At(at.position);
    const Eigen::Vector3d velocity = contact.point.At(at.velocity);
    const Eigen::Vector3d slip_change =
        -turn * normal_.dot(velocity) - normal_ * turn.dot(velocity);
    return -slope * turn.dot(position) * Direction(contact) +
           pressure * (turn - Friction() * SlipDerivative(contact, slip_change));
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  Eigen::Vector3d normal_;      // unit length
  RestQuantity<std::vector<ContactPoint>> points_;
};

}  // namespace

const EffectCard& PlaneContactCard() { return PlaneContactEffect::TheCard(); }

std::shared_ptr<const Effect> MakePlaneContact(const ContactPlane& plane) {
  const std::vector<ParameterCard>& cards = PlaneContactCard().parameters;
  Eigen::VectorXd values(PlaneContactEffect::kParameters);
  for (int k = 0; k < PlaneContactEffect::kParameters; ++k) values[k] = cards[k].default_value;
  values[PlaneContactEffect::kStiffness] = plane.stiffness;
  values.segment<3>(PlaneContactEffect::kNormal) = plane.normal;
  values[PlaneContactEffect::kOffset] = plane.offset;
  values[PlaneContactEffect::kFriction] = plane.friction;
  return std::make_shared<PlaneContactEffect>(values);
}

std::optional<ContactPlane> ContactPlaneOf(const Effect& effect) {
  if (&effect.Card() != &PlaneContactCard()) return std::nullopt;
  const Eigen::VectorXd values = effect.Parameters();
  return ContactPlane{.normal = values.segment<3>(PlaneContactEffect::kNormal),
                      .offset = values[PlaneContactEffect::kOffset],
                      .stiffness = values[PlaneContactEffect::kStiffness],
                      .friction = values[PlaneContactEffect::kFriction]};
}

const Effect* FindPlaneContact(const EffectList& effects) {
  for (const auto& effect : effects)
    if (&effect->Card() == &PlaneContactCard()) return effect.get();
  return nullptr;
}

CatalogueEntry PlaneContact() {
  return {&PlaneContactEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<PlaneContactEffect>, &ReadParameters};
}

}  // namespace lacuna
