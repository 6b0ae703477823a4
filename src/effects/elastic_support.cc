// An elastic bed that holds a part of the surface: springs that pull it to its place at rest.
//
// Winkler's bedding, with the same modulus along the normal and across it, on the boundary nodes of
// a half-space of the body at rest, fading as exp(−|X − c|²/(2 r²)) where a radius is given. It
// stands for a clamp or a ground that gives way; nodes that a grip holds do not feel it. It pulls
// as well as it pushes: what only pushes is a contact.
#include <glog/logging.h>

#include <limits>

#include "core/error.h"
#include "effects/rest_quantity.h"
#include "effects/rest_region.h"
#include "effects/vector_parameters.h"

namespace lacuna {
namespace {

constexpr Dimension kBeddingModulus{-2, 1, -2, 0, 0, "a pressure per length", "1 MPa/m", "Pa/m"};
constexpr double kMustBeGiven = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoNull = std::numeric_limits<double>::quiet_NaN();

class ElasticSupportEffect final : public Effect {
 public:
  enum Parameter { kModulus, kPoint, kNormal = kPoint + 3, kRadius = kNormal + 3 };
  static constexpr int kParameters = kRadius + 1;

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit ElasticSupportEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) override {
    CHECK_EQ(values.size(), kParameters);
    if (parameters_.size() == 0 ||
        parameters_.tail(kParameters - 1) != values.tail(kParameters - 1)) {
      areas_.Forget();
    }
    parameters_ = values;
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddScaledForce(at, parameters_[kModulus], force);
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool /*convexify*/,
                   BlockMatrix* tangent) const override {
    const auto areas = Areas(at.body);
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      tangent->Block(tangent->pattern().diagonal[i]).diagonal().array() -=
          weights.position * parameters_[kModulus] * (*areas)[i];
    }
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, kModulus) << "the others are settings";
    AddScaledForce(at, 1, derivative);
  }

  std::optional<double> Energy(const Kinematics& at) const override {
    const auto areas = Areas(at.body);
    const auto displacement = at.position.reshaped(3, areas->size()) - at.body.mesh.nodes;
    return 0.5 * parameters_[kModulus] * displacement.colwise().squaredNorm().dot(*areas);
  }

 private:
  static EffectCard MakeCard() {
    EffectCard card{
        .type = "elastic_support",
        .title = "Elastic support",
        .equation = "f_i = −k w_i A_i (x_i − X_i),  w_i = exp(−|X_i − c|²/(2 r²)) or 1",
        .citation = "E. Winkler, Die Lehre von der Elasticität und Festigkeit, Prag 1867",
        .parameters = {{.name = "modulus",
                        .meaning = "pressure per displacement, k",
                        .dimension = kBeddingModulus,
                        .bounds = kNotNegative,
                        .null_value = 0,
                        .plausible_min = 0,
                        .plausible_max = 1e7,
                        .default_value = kMustBeGiven}},
        .residual_when_missing =
            "a force against the displacement of one part of the surface, whatever the velocity: "
            "the model moves too much there and its slow modes are too slow",
        .separating_experiment =
            "take the body out of its support, or load it beside the support and away from it: a "
            "stiffer material changes both answers, a support only the first",
        .look_alikes = {"plane_contact"},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendVector({.name = "point",
                  .meaning = "a point of the plane that bounds the supported part, and the centre "
                             "of its radius, c,",
                  .dimension = kLength,
                  .null_value = kNoNull,
                  .plausible_min = -1,
                  .plausible_max = 1,
                  .setting = true},
                 Eigen::Vector3d::Zero(), &card);
    AppendVector({.name = "normal",
                  .meaning = "the support holds the boundary nodes that at rest lie on this side "
                             "of the plane; left out, on both;",
                  .dimension = kDimensionless,
                  .null_value = kNoNull,
                  .plausible_min = -1,
                  .plausible_max = 1,
                  .setting = true},
                 Eigen::Vector3d::Zero(), &card);
    card.parameters.push_back({.name = "radius",
                               .meaning = "the support fades within this distance of the point "
                                          "(standard deviation), r; 0: it does not fade",
                               .dimension = kLength,
                               .bounds = kNotNegative,
                               .null_value = kNoNull,
                               .plausible_min = 0,
                               .plausible_max = 0.1,
                               .default_value = 0,
                               .setting = true});
    return card;
  }

  // w_i A_i, m².
  std::shared_ptr<const Eigen::VectorXd> Areas(const Body& body) const {
    return areas_.Of(body, [this](const Body& at_rest) { return SupportedAreas(at_rest); });
  }

  Eigen::VectorXd SupportedAreas(const Body& body) const {
    const Eigen::Vector3d point = parameters_.segment<3>(kPoint);
    const double radius = parameters_[kRadius];
    Eigen::VectorXd areas = NodeBoundaryAreas(body).cwiseProduct(
        InHalfSpace(point, parameters_.segment<3>(kNormal), body));
    if (radius > 0) areas = areas.cwiseProduct(BumpAround(point, radius, body));
    if (areas.sum() == 0) {
      throw InputError(
          "effect elastic_support: no node of the body's surface lies on the side of its plane "
          "that `point` and `normal` name, or within its radius");
    }
    return areas;
  }

  void AddScaledForce(const Kinematics& at, double modulus, Eigen::VectorXd* force) const {
    const auto areas = Areas(at.body);
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      force->segment<3>(3 * i) -=
          modulus * (*areas)[i] * (at.position.segment<3>(3 * i) - at.body.mesh.nodes.col(i));
    }
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  RestQuantity<Eigen::VectorXd> areas_;
};

}  // namespace

CatalogueEntry ElasticSupport() {
  return {&ElasticSupportEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          [](const Eigen::VectorXd& parameters) -> std::shared_ptr<Effect> {
            return std::make_shared<ElasticSupportEffect>(parameters);
          },
          &ReadParameters};
}

}  // namespace lacuna
