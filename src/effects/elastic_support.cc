// An elastic bed that holds a part of the surface: springs that pull the nodes to their places at
// rest.
//
// This is Winkler's bedding (bedding.h) with the same modulus along the normal and tangential to
// it. It models a clamp or a ground that yields. Nodes that a grip holds are not affected. The bed
// pulls as well as it pushes; a support that can only push is a contact (plane_contact.cc).
#include <glog/logging.h>

#include "effects/bedding.h"
#include "effects/catalogue.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

class ElasticSupportEffect final : public CloneableEffect<ElasticSupportEffect> {
 public:
  enum Parameter { kModulus, kPart };

  static const EffectCard& TheCard() {
    static const EffectCard card = MakeCard();
    return card;
  }

  explicit ElasticSupportEffect(const Eigen::VectorXd& parameters) { SetParameters(parameters); }

  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), static_cast<Eigen::Index>(TheCard().parameters.size()));
    parameters_ = values;
    part_.SetParameters(values);
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    AddForceOf(*Areas(at.body), parameters_[kModulus], at, force);
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
    if (parameter == kModulus)
      AddForceOf(*Areas(at.body), 1, at, derivative);
    else
      AddForceOf(part_.AreaDerivatives(at.body, TheCard().type, parameter - kPart),
                 parameters_[kModulus], at, derivative);
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
        .family = EffectFamily::kSteadyForce,
        .title = "Elastic support",
        .equation =
            "f_i = −k w_i A_i (x_i − X_i),  w_i = exp(−|X_i − c|²/(2 r²)) or 1,  A_i of the whole "
            "surface or of one side",
        .citation = "E. Winkler, Die Lehre von der Elasticität und Festigkeit, Prag 1867",
        .parameters = {BeddingModulus()},
        .residual_when_missing =
            "The residual is a force against the displacement of one part of the surface, whatever "
            "the velocity: the model moves too much there and its slow modes are too slow.",
        .separating_experiment =
            "Take the body out of its support, or load it near the support and away from it: a "
            "stiffer material changes both responses, a support only the first. To distinguish it "
            "from a support that slips, load it further and release it: it returns completely",
        .look_alikes = {"plane_contact", "slipping_support"},
        .tried_at = TriedAsSupports{},
        .repeatable = true,
        .conserves_momentum = false,
        .conserves_angular_momentum = false};
    AppendBeddedPart(&card);
    return card;
  }

  std::shared_ptr<const Eigen::VectorXd> Areas(const Body& body) const {
    return part_.Areas(body, TheCard().type);
  }

  static void AddForceOf(const Eigen::VectorXd& areas, double modulus, const Kinematics& at,
                         Eigen::VectorXd* force) {
    for (int i = 0; i < at.body.NodeCount(); ++i) {
      force->segment<3>(3 * i) -=
          modulus * areas[i] * (at.position.segment<3>(3 * i) - at.body.mesh.nodes.col(i));
    }
  }

  Eigen::VectorXd parameters_;  // in the order of the card
  BeddedPart part_;
};

}  // namespace

CatalogueEntry ElasticSupport() {
  return {&ElasticSupportEffect::TheCard(), CatalogueEntry::Kind::kEffect,
          &MakeAs<ElasticSupportEffect>, &ReadParameters};
}

}  // namespace lacuna
