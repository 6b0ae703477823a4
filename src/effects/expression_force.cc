// A force law that the user writes as expressions in the YAML file (expression_law.h).
//
//   f_i = M_i F(x_i, X_i, v_i, t, N_i; p),
// with M_i the lumped mass (per: mass), the volume at rest (per: volume) or the boundary area at
// rest (per: area) of node i, and F three expressions, one for each axis, in N per that measure.
// N_i is the outward unit normal of the boundary at rest, and 0 inside. Measures and normals do not
// follow the deformation (a dead load), so that the force of a node depends on its own place and
// velocity alone and the tangents are diagonal blocks. With `convexify` a block is replaced by the
// negative semi-definite part of its symmetric part.
//
// docs/expression.md describes the language and the YAML. Where an expression is undefined the
// force is NaN, the step fails, and a warning names the first such node.
#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Dense>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/parallel.h"
#include "effects/catalogue.h"
#include "effects/expression_law.h"
#include "effects/rest_region.h"
#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

template <typename Number>
using Values = ExpressionLaw::Values<Number>;

using Measure = ExpressionLaw::Measure;

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
      .citation = "given by the user",
      .parameters = {},
      .residual_when_missing =
          "The residual is a force that depends on place, velocity and time as the expression "
          "says.",
      .separating_experiment =
          "Change what the expression depends on and nothing else: turn the fixture for a force "
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

class ExpressionForceEffect final : public CloneableEffect<ExpressionForceEffect> {
 public:
  explicit ExpressionForceEffect(ExpressionLaw law) : law_(std::move(law)) {}

  const ExpressionLaw& Law() const { return law_; }
  const EffectCard& Card() const override { return law_.card; }
  Eigen::VectorXd Parameters() const override { return law_.parameters; }
  void SetParameters(const Eigen::VectorXd& values) {
    CHECK_EQ(values.size(), law_.parameters.size());
    law_.parameters = values;
  }

  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    FirstNode undefined;
    ForEachNode<double>(at, [&](int node, double measure, const Values<double>& values) {
      const Eigen::Vector3d density = Evaluate(values);
      force->segment<3>(3 * node) += measure * density;
      if (!density.allFinite()) undefined.Report(node);
    });
    if (!undefined.IsNone()) WarnOnce(at, undefined.node());
  }

  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    if (!convexify) {
      AddBlocks(at, weights.position, weights.velocity, 1, Part::kSymmetric, tangent);
      return;
    }
    // Separately, because the definite part of a sum is not the sum of the definite parts.
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
      values[ExpressionLaw::kVariables + parameter].derivative[0] = 1;
      for (int axis = 0; axis < 3; ++axis)
        (*derivative)[3 * node + axis] +=
            measure * law_.force[axis].At(values.data()).derivative[0];
    });
  }

 private:
  // The lowest of the node numbers that several threads report.
  class FirstNode {
   public:
    void Report(int node) {
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
        return NodeVolumes(body);
      case Measure::kArea:
        break;
    }
    return NodeBoundaryAreas(body);
  }

  // Empty if no expression uses them.
  Eigen::Matrix3Xd Normals(const Body& body) const {
    if (!UsesAny(ExpressionLaw::kNormal, 3)) return {};
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
    set(ExpressionLaw::kPosition, position);
    set(ExpressionLaw::kRest, rest);
    set(ExpressionLaw::kDisplacement, position - rest);
    set(ExpressionLaw::kVelocity, at.velocity.segment<3>(3 * node));
    if (normals.cols() > 0) set(ExpressionLaw::kNormal, normals.col(node));
  }

  // The values that are the same at each node; all others are 0.
  template <typename Number>
  Values<Number> CommonValues(double time) const {
    Values<Number> values;
    values.fill(Constant<Number>(0));
    values[ExpressionLaw::kTime] = Constant<Number>(time);
    for (Eigen::Index k = 0; k < law_.parameters.size(); ++k)
      values[ExpressionLaw::kVariables + k] = Constant<Number>(law_.parameters[k]);
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

  // A part of a derivative; kDefinite is the definite part of its symmetric part.
  enum class Part { kSymmetric, kDefinite, kSkew };

  // Adds a part of scale · (by_position ∂f/∂x + by_velocity ∂f/∂v). Returns whether it may be
  // anything but 0.
  bool AddBlocks(const Kinematics& at, double by_position, double by_velocity, double scale,
                 Part part, BlockMatrix* tangent) const {
    const bool moves = by_position != 0 && (UsesAny(ExpressionLaw::kPosition, 3) ||
                                            UsesAny(ExpressionLaw::kDisplacement, 3));
    const bool flows = by_velocity != 0 && UsesAny(ExpressionLaw::kVelocity, 3);
    if (scale == 0 || !(moves || flows)) return false;
    FirstNode undefined;
    ForEachNode<Dual<3>>(at, [&](int node, double measure, Values<Dual<3>>& values) {
      Eigen::Matrix3d block;
      for (int axis = 0; axis < 3; ++axis) {
        values[ExpressionLaw::kPosition + axis].derivative[axis] = by_position;
        values[ExpressionLaw::kDisplacement + axis].derivative[axis] = by_position;
        values[ExpressionLaw::kVelocity + axis].derivative[axis] = by_velocity;
      }
      for (int axis = 0; axis < 3; ++axis)
        block.row(axis) = law_.force[axis].At(values.data()).derivative;
      const Eigen::Matrix3d mirror = (part == Part::kSkew ? -1 : 1) * block.transpose();
      block = 0.5 * (block + mirror);
      if (!block.allFinite()) {
        undefined.Report(node);
      } else if (part == Part::kDefinite) {
        block = NegativePart(block);
      }
      tangent->Block(tangent->pattern().diagonal[node]) += scale * measure * block;
    });
    if (!undefined.IsNone()) WarnOnce(at, undefined.node());
    return true;
  }

  // Warns that an expression is undefined at a node, and with which values.
  void WarnOnce(const Kinematics& at, int node) const {
    if (warned_->exchange(true)) return;
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
    for (int k = 0; k < static_cast<int>(ExpressionLaw::kVariables + law_.parameters.size()); ++k) {
      if (axis < 3 ? !law_.force[axis].Uses(k) : !UsesAny(k, 1)) continue;
      const std::string name = law_.NameOf(k);
      where += fmt::format("{}{} = {:g}", where.empty() ? "" : ", ", name, values[k]);
    }
    LOG(WARNING) << fmt::format("{}: {} at node {}, where {} (SI)", law_.name, what, node, where);
  }

  ExpressionLaw law_;
  // Shared by copies with other parameter values, because one warning is enough.
  std::shared_ptr<std::atomic<bool>> warned_ = std::make_shared<std::atomic<bool>>(false);
};

std::shared_ptr<const Effect> MakeExpressionForce(const Config& config) {
  return std::make_shared<ExpressionForceEffect>(ReadExpressionLaw(config, TheCard()));
}

std::string Format(const Effect& effect) {
  return FormatExpressionLaw(static_cast<const ExpressionForceEffect&>(effect).Law());
}

}  // namespace

CatalogueEntry ExpressionForce() {
  return {.card = &TheCard(),
          .make_from_yaml = &MakeExpressionForce,
          .format = &Format,
          .is_own_law = true};
}

}  // namespace lacuna
