// A force law of the user's own, written as an expression in the YAML file.
//
//   f_i = M_i F(x_i, X_i, v_i, t, N_i; p),
// with M_i the lumped mass (per: mass), the volume at rest (per: volume) or the boundary area at
// rest (per: area) of node i, and F three expressions, one for each axis, in N per that measure.
// N_i is the outward unit normal of the boundary at rest, 0 inside: measures and normals do not
// follow the deformation (a dead load), and so a node's force depends on its own place and velocity
// alone and the tangents are blocks on the diagonal. The stand-in of `convexify` is the negative
// semi-definite part of the symmetric part of each block.
//
// docs/expression.md describes the language and the YAML. Where an expression is not defined, the
// force is NaN, the step fails, and the first such place is told in a warning.
#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <utility>

#include "core/expression.h"
#include "core/parallel.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Where the variables that every law may use stand; the parameters follow.
enum Variable { kPosition, kRest = 3, kDisplacement = 6, kVelocity = 9, kTime = 12, kNormal = 13 };
constexpr int kVariables = kNormal + 3;
constexpr int kMaxParameters = 16;
const char* const kVariableNames[kVariables] = {"x",  "y",  "z",  "X",  "Y", "Z",  "ux", "uy",
                                                "uz", "vx", "vy", "vz", "t", "nx", "ny", "nz"};

template <typename Number>
using Values = std::array<Number, kVariables + kMaxParameters>;

enum class Measure { kMass, kVolume, kArea };

// What the YAML file says.
struct Law {
  std::string name;
  Measure per = Measure::kMass;
  std::vector<Expression> force;  // one for each axis
  EffectCard card;                // the amplitude first
  Eigen::VectorXd parameters;     // in the order of the card
};

const EffectCard& TheCard() {
  static const EffectCard card{
      .type = "expression",
      .title = "A force law of your own, written as an expression",
      .equation =
          "f_i = M_i F(x, y, z, X, Y, Z, ux, uy, uz, vx, vy, vz, t, nx, ny, nz; parameters), with "
          "M_i the mass, volume or boundary area of node i; e.g. {type: expression, name: magnet, "
          "per: mass, force: [0, 0, \"-k * exp(-z/d)\"], parameters: {k: {value: 3 N/kg, "
          "plausible: [0, 10 N/kg]}, d: {value: 5 mm, setting: true}}}; docs/expression.md "
          "describes it in full",
      .citation = "the user's own",
      .parameters = {},
      .residual_when_missing =
          "an unexplained force that depends on place, velocity and time as "
          "the expression says",
      .separating_experiment =
          "change what the expression depends on and nothing else: turn the fixture for a force "
          "that depends on place, repeat at another speed for one that depends on velocity",
      .look_alikes = {},
      .repeatable = true,
      .conserves_momentum = false,
      .conserves_angular_momentum = false};
  return card;
}

// The part of a symmetric matrix with no positive eigenvalue.
Eigen::Matrix3d NegativePart(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMin(0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

class ExpressionForceEffect final : public Effect {
 public:
  explicit ExpressionForceEffect(Law law) : law_(std::move(law)) {}

  const EffectCard& Card() const override { return law_.card; }
  Eigen::VectorXd Parameters() const override { return law_.parameters; }
  void SetParameters(const Eigen::VectorXd& values) override {
    CHECK_EQ(values.size(), law_.parameters.size());
    law_.parameters = values;
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    FirstNode undefined;
    ForEachNode<double>(at, [&](int node, double measure, const Values<double>& values) {
      const Eigen::Vector3d density = Evaluate(values);
      force->segment<3>(3 * node) += measure * density;
      if (!density.allFinite()) undefined.Tell(node);
    });
    if (!undefined.IsNone()) WarnOnce(at, undefined.node());
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (!convexify) {
      AddBlocks(at, weights.position, weights.velocity, 1, Part::kSymmetric, tangent);
      return;
    }
    // Each by itself: the definite part of a sum is not the sum of the definite parts.
    AddBlocks(at, 1, 0, weights.position, Part::kDefinite, tangent);
    AddBlocks(at, 0, 1, weights.velocity, Part::kDefinite, tangent);
  }

  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    return AddBlocks(at, weights.position, weights.velocity, 1, Part::kSkew, tangent);
  }

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK(parameter >= 0 && parameter < law_.parameters.size());
    ForEachNode<Dual<1>>(at, [&](int node, double measure, Values<Dual<1>>& values) {
      values[kVariables + parameter].derivative[0] = 1;
      for (int axis = 0; axis < 3; ++axis)
        (*derivative)[3 * node + axis] +=
            measure * law_.force[axis].At(values.data()).derivative[0];
    });
  }

 private:
  // The first of the nodes that threads tell of.
  class FirstNode {
   public:
    void Tell(int node) {
      for (int first = node_; node < first && !node_.compare_exchange_weak(first, node);) {
      }
    }
    int node() const { return node_; }
    bool IsNone() const { return node_ == kNoNode; }

   private:
    static constexpr int kNoNode = std::numeric_limits<int>::max();
    std::atomic<int> node_ = kNoNode;
  };

  template <typename Number>
  static Number Constant(double value) {
    if constexpr (std::is_same_v<Number, double>) {
      return value;
    } else {
      return Number::Constant(value);
    }
  }

  bool UsesAny(int first, int count) const {
    for (const Expression& force : law_.force)
      for (int k = first; k < first + count; ++k)
        if (force.Uses(k)) return true;
    return false;
  }

  Eigen::VectorXd Measures(const Body& body) const {
    switch (law_.per) {
      case Measure::kMass:
        return body.node_mass;
      case Measure::kVolume:
        return body.node_mass / body.density;
      case Measure::kArea:
        break;
    }
    return NodeBoundaryAreas(body);
  }

  // Empty where no expression asks for them.
  Eigen::Matrix3Xd Normals(const Body& body) const {
    if (!UsesAny(kNormal, 3)) return {};
    Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, body.NodeCount());
    normals(Eigen::all, body.boundary.node) = VertexNormals(body.boundary.surface);
    return normals;
  }

  template <typename Number>
  static void SetPoint(const Kinematics& at, const Eigen::Matrix3Xd& normals, int node,
                       Values<Number>* values) {
    const auto set = [values](int first, const Eigen::Vector3d& vector) {
      for (int axis = 0; axis < 3; ++axis) (*values)[first + axis] = Constant<Number>(vector[axis]);
    };
    const Eigen::Vector3d position = at.position.segment<3>(3 * node);
    const Eigen::Vector3d rest = at.body.mesh.nodes.col(node);
    set(kPosition, position);
    set(kRest, rest);
    set(kDisplacement, position - rest);
    set(kVelocity, at.velocity.segment<3>(3 * node));
    if (normals.cols() > 0) set(kNormal, normals.col(node));
  }

  // All that is the same at each node; the rest 0.
  template <typename Number>
  Values<Number> CommonValues(double time) const {
    Values<Number> values;
    values.fill(Constant<Number>(0));
    values[kTime] = Constant<Number>(time);
    for (Eigen::Index k = 0; k < law_.parameters.size(); ++k)
      values[kVariables + k] = Constant<Number>(law_.parameters[k]);
    return values;
  }

  // Calls visit(node, measure, values) with all derivatives 0 for the nodes that have a measure.
  template <typename Number, typename Visit>
  void ForEachNode(const Kinematics& at, const Visit& visit) const {
    const Eigen::VectorXd measures = Measures(at.body);
    const Eigen::Matrix3Xd normals = Normals(at.body);
    ParallelBlocks(measures.size(), 64, [&](int64_t begin, int64_t end) {
      Values<Number> values = CommonValues<Number>(at.time);
      for (int64_t node = begin; node < end; ++node) {
        if (measures[node] == 0) continue;
        SetPoint(at, normals, static_cast<int>(node), &values);
        visit(static_cast<int>(node), measures[node], values);
      }
    });
  }

  Eigen::Vector3d Evaluate(const Values<double>& values) const {
    return {law_.force[0].At(values.data()), law_.force[1].At(values.data()),
            law_.force[2].At(values.data())};
  }

  // Of a derivative; kDefinite: of its symmetric part.
  enum class Part { kSymmetric, kDefinite, kSkew };

  // Adds a part of scale · (by_position ∂f/∂x + by_velocity ∂f/∂v). Returns whether it may be
  // anything but 0.
  bool AddBlocks(const Kinematics& at, double by_position, double by_velocity, double scale,
                 Part part, BlockMatrix* tangent) const {
    const bool moves = by_position != 0 && (UsesAny(kPosition, 3) || UsesAny(kDisplacement, 3));
    const bool flows = by_velocity != 0 && UsesAny(kVelocity, 3);
    if (scale == 0 || !(moves || flows)) return false;
    FirstNode undefined;
    ForEachNode<Dual<3>>(at, [&](int node, double measure, Values<Dual<3>>& values) {
      Eigen::Matrix3d block;
      for (int axis = 0; axis < 3; ++axis) {
        values[kPosition + axis].derivative[axis] = by_position;
        values[kDisplacement + axis].derivative[axis] = by_position;
        values[kVelocity + axis].derivative[axis] = by_velocity;
      }
      for (int axis = 0; axis < 3; ++axis)
        block.row(axis) = law_.force[axis].At(values.data()).derivative;
      const Eigen::Matrix3d mirror = (part == Part::kSkew ? -1 : 1) * block.transpose();
      block = 0.5 * (block + mirror);
      if (!block.allFinite()) {
        undefined.Tell(node);
      } else if (part == Part::kDefinite) {
        block = NegativePart(block);
      }
      tangent->Block(tangent->pattern().diagonal[node]) += scale * measure * block;
    });
    if (!undefined.IsNone()) WarnOnce(at, undefined.node());
    return true;
  }

  // Tells what is not defined at a node.
  void WarnOnce(const Kinematics& at, int node) const {
    if (warned_.exchange(true)) return;
    Values<double> values = CommonValues<double>(at.time);
    SetPoint(at, Normals(at.body), node, &values);
    const Eigen::Vector3d density = Evaluate(values);
    int axis = 0;
    while (axis < 3 && std::isfinite(density[axis])) ++axis;
    const std::string what =
        axis < 3 ? fmt::format("force[{}], \"{}\", is {}", axis, law_.force[axis].text(),
                               std::isnan(density[axis]) ? "not a number" : "infinite")
                 : "the derivative of the force by place or velocity is not finite";
    std::string where;
    for (int k = 0; k < static_cast<int>(kVariables + law_.parameters.size()); ++k) {
      if (axis < 3 ? !law_.force[axis].Uses(k) : !UsesAny(k, 1)) continue;
      const std::string name =
          k < kVariables ? kVariableNames[k] : law_.card.parameters[k - kVariables].name;
      where += fmt::format("{}{} = {:g}", where.empty() ? "" : ", ", name, values[k]);
    }
    LOG(WARNING) << fmt::format("{}: {} at node {}, where {} (SI)", law_.name, what, node, where);
  }

  Law law_;
  mutable std::atomic<bool> warned_ = false;
};

// A quantity of this dimension, where a bare 0 needs no unit.
double ReadLike(const Config& config, const std::string& key, const Dimension& dimension,
                const Bounds& bounds) {
  const MeasuredQuantity any = config.AnyQuantity(key);
  if (any.value == 0 && any.dimension.SameAs(kDimensionless)) return 0;
  return config.Quantity(key, dimension, bounds);
}

// `{value: 3 N/kg, plausible: [-10 N/kg, 10 N/kg], null_value: 0, min: …, max: …, log_scale: false,
// setting: false, meaning: …}`
ParameterCard ReadParameterCard(const Config& config, const std::string& name, double* value) {
  ParameterCard card;
  card.name = name;
  card.meaning = config.Text("meaning", "parameter of the law");
  card.dimension = config.AnyQuantity("value").dimension;
  card.setting = config.Flag("setting", false);
  card.log_scale = config.Flag("log_scale", false);
  if (config.Has("min")) card.bounds.min = ReadLike(config, "min", card.dimension, kAnyValue);
  if (config.Has("max")) card.bounds.max = ReadLike(config, "max", card.dimension, kAnyValue);
  if (!(card.bounds.min < card.bounds.max)) config.Fail("max", "expected more than min");
  if (card.log_scale && card.bounds.min <= 0) {
    card.bounds.min = 0;
    card.bounds.open_min = true;
  }
  *value = config.Quantity("value", card.dimension, card.bounds);
  card.default_value = *value;
  card.null_value =
      config.Has("null_value") ? ReadLike(config, "null_value", card.dimension, kAnyValue) : kNone;
  const std::vector<double> plausible = config.Quantities("plausible", card.dimension, card.bounds);
  if (plausible.size() == 2 && plausible[0] < plausible[1]) {
    card.plausible_min = plausible[0];
    card.plausible_max = plausible[1];
  } else if (plausible.empty() && card.setting) {
    const double width = *value == 0 ? 1 : std::abs(*value);
    card.plausible_min = std::max(*value - width, card.bounds.min);
    card.plausible_max = std::min(*value + width, card.bounds.max);
  } else {
    const std::string unit = card.dimension.unit;
    config.Fail("plausible",
                fmt::format("expected the least and the largest value that make sense, e.g. "
                            "[-10{0}, 10{0}]; a parameter that is not to be fitted needs none if "
                            "it says `setting: true`",
                            unit.empty() ? "" : " " + unit));
  }
  if (card.plausible_min < card.bounds.min || card.plausible_max > card.bounds.max)
    config.Fail("plausible", "reaches beyond the bounds min and max");
  if (card.log_scale && card.plausible_min <= 0)
    config.Fail("plausible", "a logarithmic scale has only values > 0");
  return card;
}

void ReadLawParameters(const Config& config, Law* law) {
  const Config list = config.Child("parameters");
  const std::vector<std::string> names = list.Keys();
  if (names.size() > kMaxParameters)
    config.Fail("parameters", fmt::format("expected at most {}", kMaxParameters));
  std::vector<double> values;
  std::vector<std::pair<std::string, size_t>> amplitudes;
  for (const std::string& name : names) {
    if (!Expression::IsName(name))
      list.Fail(name, "expected a name of letters, digits and underscores");
    const auto& reserved = Expression::ReservedNames();
    if (std::find(reserved.begin(), reserved.end(), name) != reserved.end() ||
        std::find(kVariableNames, kVariableNames + kVariables, name) != kVariableNames + kVariables)
      list.Fail(name, "this name means something else in an expression");
    values.push_back(0);
    law->card.parameters.push_back(ReadParameterCard(list.Child(name), name, &values.back()));
    if (!law->card.parameters.back().setting) amplitudes.emplace_back(name, values.size() - 1);
  }
  if (amplitudes.empty()) {
    config.Fail(
        "parameters",
        "expected one that is not a setting: the size of the force, with which it vanishes");
  }
  const size_t amplitude = config.Choice("amplitude", amplitudes, amplitudes.front().first);
  auto& cards = law->card.parameters;
  std::rotate(cards.begin(), cards.begin() + static_cast<std::ptrdiff_t>(amplitude),
              cards.begin() + static_cast<std::ptrdiff_t>(amplitude) + 1);
  std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(amplitude),
              values.begin() + static_cast<std::ptrdiff_t>(amplitude) + 1);
  if (std::isnan(cards.front().null_value)) cards.front().null_value = 0;
  const Bounds& bounds = cards.front().bounds;
  if (!(cards.front().null_value >= bounds.min && cards.front().null_value <= bounds.max)) {
    list.Child(cards.front().name)
        .Fail("", fmt::format("the null value {:g} of the amplitude is out of its bounds",
                              cards.front().null_value));
  }
  law->parameters =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void ReadForce(const Config& config, Law* law) {
  const std::vector<std::string> texts = config.Texts("force");
  if (texts.size() != 3) {
    config.Fail(
        "force",
        fmt::format("got {} entries; expected three expressions, e.g. [0, 0, \"-k * z\"], in "
                    "quotes where they have a comma",
                    texts.size()));
  }
  std::vector<std::string> names(kVariableNames, kVariableNames + kVariables);
  for (const ParameterCard& parameter : law->card.parameters) names.push_back(parameter.name);
  for (size_t axis = 0; axis < 3; ++axis) {
    try {
      law->force.emplace_back(texts[axis], names);
    } catch (const ExpressionError& problem) {
      config.FailAtItem("force", axis, fmt::format("\"{}\", {}", texts[axis], problem.what()));
    }
  }
  for (size_t k = 0; k < law->card.parameters.size(); ++k) {
    if (std::none_of(law->force.begin(), law->force.end(),
                     [&](const Expression& force) { return force.Uses(kVariables + k); })) {
      config.Child("parameters")
          .Fail(law->card.parameters[k].name, "stands in none of the three expressions");
    }
  }
}

// The diagnosis asks what the law would add where it is absent, so it must vanish at the null value
// of its amplitude, but not its derivative. Tried at places, velocities and times of any size up to
// 1 m, 1 m/s and 10 s.
void CheckAmplitude(const Config& config, const Law& law) {
  const ParameterCard& amplitude = law.card.parameters.front();
  const double farthest = std::abs(amplitude.plausible_max - amplitude.null_value) >
                                  std::abs(amplitude.plausible_min - amplitude.null_value)
                              ? amplitude.plausible_max
                              : amplitude.plausible_min;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  bool acts = false, grows = false;
  for (int trial = 0; trial < 200; ++trial) {
    Values<Dual<1>> values;
    const double size = std::pow(10.0, -(trial % 4));
    for (int k = 0; k < kVariables; ++k) values[k] = Dual<1>::Constant(size * uniform(random));
    for (int axis = 0; axis < 3; ++axis)
      values[kDisplacement + axis].value =
          values[kPosition + axis].value - values[kRest + axis].value;
    Eigen::Vector3d normal(uniform(random), uniform(random), uniform(random));
    normal.normalize();
    for (int axis = 0; axis < 3; ++axis) values[kNormal + axis].value = normal[axis];
    values[kTime].value = 10 * std::abs(values[kTime].value);
    for (Eigen::Index k = 0; k < law.parameters.size(); ++k)
      values[kVariables + k] = Dual<1>::Constant(law.parameters[k]);
    for (size_t axis = 0; axis < 3; ++axis) {
      values[kVariables] = Dual<1>::Constant(farthest);
      const double full = law.force[axis].At(values.data()).value;
      values[kVariables] = Dual<1>::Variable(amplitude.null_value, 0);
      const Dual<1> null = law.force[axis].At(values.data());
      // Beyond rounding; a place where the law is not defined tells nothing.
      if (std::abs(null.value) > 1e-12 * std::abs(full)) {
        config.FailAtItem(
            "force", axis,
            fmt::format("\"{}\" must vanish when {}, the amplitude, is {:g}, but is {:g} at {}",
                        law.force[axis].text(), amplitude.name, amplitude.null_value, null.value,
                        fmt::format("x = {:g}, y = {:g}, z = {:g}", values[0].value,
                                    values[1].value, values[2].value)));
      }
      acts = acts || (std::isfinite(full) && full != 0);
      grows = grows || !(null.derivative[0] == 0);
    }
  }
  if (acts && !grows) {
    config.Fail("force", fmt::format("must grow in proportion to {0}, the amplitude, where that is "
                                     "{1:g}, unlike {0}^2 or abs({0}): its derivative is 0 there",
                                     amplitude.name, amplitude.null_value));
  }
}

std::shared_ptr<Effect> MakeExpressionForce(const Config& config) {
  Law law;
  law.name = config.Text("name");
  law.per = config.Choice<Measure>(
      "per", {{"mass", Measure::kMass}, {"volume", Measure::kVolume}, {"area", Measure::kArea}});
  law.card = TheCard();
  law.card.title = fmt::format("{}, a force law of the user's own", law.name);
  law.card.citation = config.Text("citation", "the user's own; language: docs/expression.md");
  ReadLawParameters(config, &law);
  ReadForce(config, &law);
  const char* measure = law.per == Measure::kMass     ? "m_i"
                        : law.per == Measure::kVolume ? "V_i"
                                                      : "A_i";
  law.card.equation = fmt::format("f_i = {} ({}, {}, {})", measure, law.force[0].text(),
                                  law.force[1].text(), law.force[2].text());
  CheckAmplitude(config, law);
  return std::make_shared<ExpressionForceEffect>(std::move(law));
}

}  // namespace

CatalogueEntry ExpressionForce() {
  CatalogueEntry entry;
  entry.card = &TheCard();
  entry.make_from_yaml = &MakeExpressionForce;
  return entry;
}

}  // namespace lacuna
