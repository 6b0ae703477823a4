// Swelling, shrinking or thermal expansion that depends on the place: the free strain of
// swelling.cc, ε, is the product of one number and of a field that the user writes as an expression
// of the place in the rest shape, ε(X) = ε₀ g(X). With the stretch s = 1 + ε(X),
//   ψ = s³ ψ_el(F/s) − ψ_el(F),
// where ψ_el is the elasticity law of the body. For g = 1 this is `swelling`.
//
// With the quadrature of the body (weights w, shape gradients ∂N/∂X) the first term is the energy
// that the law stores on a body with the weights s³ w and the gradients ∂N/∂X / s: the swollen
// body, whose elements need not fit together. Force, energy and tangent therefore are those of the
// law on the swollen body minus those on the body. Two free strains in one model would each add
// such a difference, which is not that of the product of their stretches (two of 10 % would enlarge
// a body of linear elasticity by 18.3 %, not 21 %); the card therefore excludes it. The derivative
// is
//   ∂f/∂ε₀ = 2 f′ − (∂f′/∂x) x,
// where f′ is the force of the law on the swollen body with its weights multiplied by g/s.
#include <fmt/format.h>
#include <glog/logging.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/expression.h"
#include "core/quoted_text.h"
#include "effects/catalogue.h"
#include "effects/free_strain.h"
#include "effects/rest_quantity.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

const EffectCard& TheCard() {
  static const EffectCard card{
      .type = "swelling_field",
      .family = EffectFamily::kVolumeStress,
      .title = "Swelling or thermal expansion that depends on the place",
      .equation =
          "ψ = s³ ψ_el(F/s) − ψ_el(F),  s = 1 + ε₀ g(X, Y, Z),  ψ_el the body's elasticity law, "
          "g an expression of the place at rest in m, e.g. {type: swelling_field, strain: 0.1 %, "
          "field: \"1 + Z/0.02\"}; docs/expression.md describes the language. What other effects "
          "add to the material, such as an inclusion or fibres, refers to F: it does not swell. A "
          "model has one free strain; several are one field, the product of their stretches less 1",
      .citation =
          "J. M. C. Duhamel, Second mémoire sur les phénomènes thermo-mécaniques, J. de l'École "
          "Polytechnique 15, 1837, 1–57; E. K. Rodriguez, A. Hoger, A. D. McCulloch, "
          "Stress-Dependent Finite Growth in Soft Elastic Tissues, Journal of Biomechanics 27, "
          "1994, 455–467",
      .parameters = {{.name = "strain",
                      .meaning = "linear strain, ε₀, that a free body would have where the field "
                                 "is 1",
                      .dimension = kDimensionless,
                      .bounds = kAnyValue,
                      .null_value = 0,
                      .plausible_min = -0.1,
                      .plausible_max = 0.1,
                      .default_value = kMustBeGiven}},
      .residual_when_missing =
          "Even without load the body is bent or bulges, away from the side that is longer. The "
          "residual does not change with the load.",
      .separating_experiment =
          "Remove all load and turn the body upside down: the shape stays as it is, the sag of "
          "gravity changes sign. Wait until temperature and moisture are the same everywhere: the "
          "body becomes straight",
      .look_alikes = {"swelling", "gravity"},
      .excludes = {"swelling"},
      .conserves_momentum = true,
      .conserves_angular_momentum = true};
  return card;
}

class SwellingFieldEffect final : public CloneableEffect<SwellingFieldEffect, FreeStrain> {
 public:
  SwellingFieldEffect(double strain, Expression field)
      : field_(std::make_shared<const Expression>(std::move(field))) {
    SetParameters(Eigen::VectorXd::Constant(1, strain));
  }

  const Expression& Field() const { return *field_; }
  const EffectCard& Card() const override { return TheCard(); }
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, strain_); }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), 1);
    strain_ = values[0];
    swollen_.SetSettings(values);
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, 0);
    const Eigen::VectorXd stretch = Stretches(at.body);
    Body weighted = MakeSwollen(at.body, stretch);
    weighted.weight.array() *= FieldAtPoints(at.body)->array() / stretch.array();
    AddForceAndStiffness(at, AsSeenByLaw(at, weighted, at.position), 2, derivative);
  }

 private:
  bool HasNoStrain() const override { return strain_ == 0; }

  void WithElasticPart(const Kinematics& at,
                       const std::function<void(const ElasticPart&)>& use) const override {
    const auto swollen = Swollen(at.body);
    use({AsSeenByLaw(at, *swollen, at.position)});
  }

  // g at the quadrature points.
  std::shared_ptr<const Eigen::VectorXd> FieldAtPoints(const Body& body) const {
    return at_points_.Of(body, [this](const Body& rest, const Eigen::VectorXd& /*settings*/) {
      Eigen::VectorXd values(rest.PointCount());
      for (Eigen::Index q = 0; q < values.size(); ++q) {
        const Eigen::Vector3d point = rest.point.col(q);
        values[q] = field_->At(point.data());
        if (!std::isfinite(values[q])) WarnOnce("is not a finite number", point);
      }
      return values;
    });
  }

  // s at the quadrature points; not a number where the strain is −1 or less, because nothing can
  // shrink that far.
  Eigen::VectorXd Stretches(const Body& body) const override {
    const Eigen::ArrayXd stretch = 1 + strain_ * FieldAtPoints(body)->array();
    Eigen::Index least = 0;
    if (stretch.minCoeff(&least) <= 0)
      WarnOnce(fmt::format("times {:g} is a strain of {:g}, and nothing can shrink by 100 %",
                           strain_, stretch[least] - 1),
               body.point.col(least));
    return (stretch > 0).select(stretch, std::numeric_limits<double>::quiet_NaN());
  }

  void WarnOnce(const std::string& problem, const Eigen::Vector3d& point) const {
    if (warned_->exchange(true)) return;
    LOG(WARNING) << fmt::format("{}: \"{}\" {} at X = {:g}, Y = {:g}, Z = {:g} m", TheCard().type,
                                field_->text(), problem, point[0], point[1], point[2]);
  }

  static Body MakeSwollen(const Body& body, const Eigen::VectorXd& stretch) {
    Body swollen = body;
    // Not owned: the value would otherwise keep the mesh alive that it is kept for.
    swollen.schedule = {std::shared_ptr<void>(), body.schedule.get()};
    swollen.weight.array() *= stretch.array().cube();
    for (Eigen::Index q = 0; q < stretch.size(); ++q)
      swollen.shape_gradient.middleCols<3>(3 * q) /= stretch[q];
    return swollen;
  }

  std::shared_ptr<const Body> Swollen(const Body& body) const {
    return swollen_.Of(body, [this](const Body& rest, const Eigen::VectorXd& /*strain*/) {
      return MakeSwollen(rest, Stretches(rest));
    });
  }

  double strain_ = 0;                        // ε₀
  std::shared_ptr<const Expression> field_;  // g
  RestQuantity<Eigen::VectorXd> at_points_;  // g, shared by copies with another strain
  RestQuantity<Body> swollen_;
  // Shared by copies with another strain, because one warning is enough.
  std::shared_ptr<std::atomic<bool>> warned_ = std::make_shared<std::atomic<bool>>(false);
};

std::shared_ptr<const Effect> MakeSwellingField(const Config& config) {
  const ParameterCard& strain = TheCard().parameters.front();
  const double value = config.Quantity(strain.name, strain.dimension, strain.bounds);
  const std::string text = config.Text("field");
  try {
    return std::make_shared<SwellingFieldEffect>(value, Expression(text, {"X", "Y", "Z"}));
  } catch (const ExpressionError& problem) {
    config.Fail("field", fmt::format("\"{}\", {}", text, problem.what()));
  }
}

std::string Format(const Effect& effect) {
  const auto& swelling = static_cast<const SwellingFieldEffect&>(effect);
  return fmt::format("{{type: {}, strain: {}, field: {}}}", TheCard().type,
                     swelling.Parameters()[0], QuotedText(swelling.Field().text()));
}

}  // namespace

CatalogueEntry SwellingField() {
  return {.card = &TheCard(), .make_from_yaml = &MakeSwellingField, .format = &Format};
}

}  // namespace lacuna
