#include "support/check_effect.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "core/parallel.h"
#include "support/box_mesh.h"
#include "support/dense_matrix.h"

namespace lacuna {
namespace {

struct Motion {
  Eigen::VectorXd position, velocity, acceleration;
};

// A block whose elements all differ, moved and deformed at random.
struct MovingBody {
  Body body;
  Motion motion = {};
  Eigen::VectorXd state = {};  // after a step with other strains than now
};

Motion Shifted(const Motion& motion, const TangentWeights& by, const Eigen::VectorXd& shift) {
  return {motion.position + by.position * shift, motion.velocity + by.velocity * shift,
          motion.acceleration + by.acceleration * shift};
}

Eigen::VectorXd Random(Eigen::Index size, std::mt19937* random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(*random); });
}

MovingBody MakeMovingBody(const Effect& effect, int order, const std::array<int, 3>& cells,
                          const CheckEffectOptions& options) {
  constexpr double kCell = 0.02;  // m
  std::mt19937 random(options.seed);
  const Eigen::Vector3d low(0.01, -0.03, 0.02);
  TetMesh mesh = BoxMesh(low, low + kCell * Eigen::Vector3d(cells[0], cells[1], cells[2]), cells);
  mesh = Jittered(mesh, kCell, 0.15, options.seed);
  MovingBody moving{.body = MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1100)};
  const Eigen::Index size = 3 * moving.body.NodeCount();
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix3Xd nodes = moving.body.mesh.nodes;
  // Nodes of quadratic elements are half as far apart.
  nodes.reshaped() += 0.25 * options.strain * kCell / order * Random(size, &random);
  nodes = (rotation * nodes).colwise() + Eigen::Vector3d(0.05, -0.02, 0.01);
  Motion& motion = moving.motion;
  motion.position = nodes.reshaped();
  motion.velocity = 0.25 * options.strain_rate * kCell / order * Random(size, &random);
  motion.acceleration = 10 * Random(size, &random);
  moving.state.resize(effect.StateSize(moving.body));
  effect.InitialState(moving.body, &moving.state);
  const Eigen::VectorXd before =
      motion.position + 0.25 * options.strain * kCell / order * Random(size, &random);
  const Eigen::VectorXd at_rest = moving.state;
  effect.AdvanceState({moving.body, before, motion.velocity, motion.acceleration,
                       options.time - options.time_step, options.time_step, at_rest},
                      &moving.state);
  return moving;
}

class Checker {
 public:
  Checker(const Effect* effect, int order, const CheckEffectOptions& options)
      : effect_(*effect),
        options_(options),
        order_(order),
        moving_(MakeMovingBody(*effect, order, {2, 1, 2}, options)),
        size_(moving_.motion.position.size()) {}

  void Run() {
    CheckEnergy();
    CheckStress();
    CheckTangent("position", {.position = 1}, options_.depends_on_position);
    CheckTangent("velocity", {.velocity = 1}, options_.depends_on_velocity);
    CheckTangent("acceleration", {.acceleration = 1}, options_.depends_on_acceleration);
    CheckTangentsAdd();
    CheckStandIn();
    CheckParameters();
    CheckMemory();
    CheckElasticityDerivatives();
    CheckInvariances();
    CheckThreads();
  }

 private:
  Kinematics At(const Motion& motion) const {
    return {moving_.body,        motion.position,    motion.velocity, motion.acceleration,
            options_.time,       options_.time_step, moving_.state,   options_.elasticity,
            /*has_inertia=*/true};
  }

  Eigen::VectorXd Force(const Motion& motion) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(size_);
    effect_.AddForce(At(motion), &force);
    return force;
  }

  Eigen::MatrixXd SkewTangent(const TangentWeights& weights) const {
    BlockMatrix tangent(moving_.body.pattern);
    const bool any = effect_.AddSkewTangents(At(moving_.motion), weights, &tangent);
    const Eigen::MatrixXd dense = Dense(tangent);
    EXPECT_TRUE(any || dense.isZero(0)) << "a skew part that was said not to be there";
    return dense;
  }

  Eigen::MatrixXd Tangent(const TangentWeights& weights, bool convexify) const {
    BlockMatrix tangent(moving_.body.pattern);
    effect_.AddTangents(At(moving_.motion), weights, convexify, &tangent);
    return Dense(tangent);
  }

  // The smallest relative error of `analytic` against central differences of `value` over step
  // sizes from coarse (truncation) to fine (rounding).
  template <typename Value, typename Result>
  static double BestError(const Value& value, const Result& analytic, double unit) {
    double best = std::numeric_limits<double>::infinity();
    for (const double relative : {1e-3, 1e-4, 1e-5, 1e-6}) {
      const double h = relative * unit;
      const Result difference = (value(h) - value(-h)) / (2 * h);
      best = std::min(best, (difference - analytic).norm() / analytic.norm());
    }
    return best;
  }

  void CheckEnergy() const {
    const auto energy = effect_.Energy(At(moving_.motion));
    if (!energy) return;
    ASSERT_TRUE(std::isfinite(*energy));
    std::mt19937 random(options_.seed + 1);
    const Eigen::VectorXd force = Force(moving_.motion);
    ASSERT_GT(force.norm(), 0);
    for (int k = 0; k < 3; ++k) {
      // A component along the force itself keeps the derivative away from zero.
      const Eigen::VectorXd direction = Random(size_, &random) + force / force.norm();
      const auto value = [&](double h) {
        const Motion shifted = Shifted(moving_.motion, {.position = h}, direction);
        return Eigen::Matrix<double, 1, 1>(-*effect_.Energy(At(shifted)));
      };
      const Eigen::Matrix<double, 1, 1> power(force.dot(direction));
      EXPECT_LT(BestError(value, power, 0.001), options_.tolerance) << "f = −∂E/∂x";
    }
  }

  // The stress, where the effect is one, integrates to the forces.
  void CheckStress() const {
    const Body& body = moving_.body;
    Eigen::Matrix3Xd stress = Eigen::Matrix3Xd::Zero(3, 3 * body.PointCount());
    if (!effect_.AddStress(At(moving_.motion), &stress)) {
      EXPECT_TRUE(stress.isZero(0)) << "an effect that is no stress added one";
      return;
    }
    Eigen::VectorXd force = Eigen::VectorXd::Zero(size_);
    for (int q = 0; q < body.PointCount(); ++q) {
      const Eigen::Matrix3d P = body.weight[q] * stress.middleCols<3>(3 * q);
      const auto gradient = body.shape_gradient.middleCols<3>(3 * q);
      for (Eigen::Index a = 0; a < gradient.rows(); ++a)
        force.segment<3>(3 * body.mesh.tets(a, q / body.points_per_element)) -=
            P * gradient.row(a).transpose();
    }
    const Eigen::VectorXd expected = Force(moving_.motion);
    EXPECT_LT((force - expected).norm(), 1e-12 * expected.norm()) << "f = −Σ w P ∂N/∂X";
  }

  void CheckTangent(const std::string& name, const TangentWeights& weights, bool depends) const {
    const Eigen::MatrixXd tangent = Tangent(weights, false);
    const auto derivative = [&](double h) {
      Eigen::MatrixXd columns(size_, size_);
      for (Eigen::Index k = 0; k < size_; ++k) {
        const Eigen::VectorXd shift = h * Eigen::VectorXd::Unit(size_, k);
        columns.col(k) = Force(Shifted(moving_.motion, weights, shift));
      }
      return columns;
    };
    if (!depends) {
      EXPECT_EQ(tangent.norm(), 0) << "∂f/∂" << name << " was said to be zero";
      EXPECT_EQ((derivative(1e-4) - derivative(-1e-4)).norm(), 0) << "∂f/∂" << name;
      return;
    }
    ASSERT_GT(tangent.norm(), 0) << "∂f/∂" << name << " is zero";
    EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-13 * tangent.norm());
    const Eigen::MatrixXd skew = SkewTangent(weights);
    EXPECT_LE((skew + skew.transpose()).norm(), 1e-13 * tangent.norm());
    const double unit = weights.position == 0 ? 1 : 0.01;  // m/s, m/s² or m
    EXPECT_LT(BestError(derivative, Eigen::MatrixXd(tangent + skew), unit), options_.tolerance)
        << "∂f/∂" << name;
  }

  void CheckTangentsAdd() const {
    BlockMatrix twice(moving_.body.pattern);
    const Kinematics at = At(moving_.motion);
    effect_.AddTangents(at, {.position = 1.5, .acceleration = 2}, false, &twice);
    effect_.AddTangents(at, {.velocity = -0.5}, false, &twice);
    const Eigen::MatrixXd sum = 1.5 * Tangent({.position = 1}, false) -
                                0.5 * Tangent({.velocity = 1}, false) +
                                2 * Tangent({.acceleration = 1}, false);
    EXPECT_LE((Dense(twice) - sum).norm(), 1e-13 * sum.norm()) << "tangents add, by their weights";
    BlockMatrix skew(moving_.body.pattern);
    effect_.AddSkewTangents(at, {.position = 1.5, .acceleration = 2}, &skew);
    effect_.AddSkewTangents(at, {.velocity = -0.5}, &skew);
    const Eigen::MatrixXd skew_sum =
        1.5 * SkewTangent({.position = 1}) - 0.5 * SkewTangent({.velocity = 1});
    EXPECT_LE((Dense(skew) - skew_sum).norm(), 1e-13 * sum.norm()) << "and so do skew parts";

    Eigen::VectorXd force = Eigen::VectorXd::Ones(size_);
    effect_.AddForce(at, &force);
    const Eigen::VectorXd alone = Force(moving_.motion);
    EXPECT_LE((force - alone - Eigen::VectorXd::Ones(size_)).norm(), 1e-13 * force.norm())
        << "forces add";
  }

  void CheckStandIn() const {
    const Eigen::MatrixXd stand_in = Tangent({1, 1, 1}, true);
    const double largest = stand_in.norm();
    EXPECT_LE((stand_in - stand_in.transpose()).norm(), 1e-13 * largest);
    const Eigen::VectorXd eigenvalues = stand_in.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_LE(eigenvalues.maxCoeff(), 1e-12 * largest) << "negative semi-definite";
  }

  // The force in motion with other parameter values.
  Eigen::VectorXd ForceWith(const Eigen::VectorXd& values) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(size_);
    effect_.WithParameters(values)->AddForce(At(moving_.motion), &force);
    return force;
  }

  void CheckParameters() const {
    const EffectCard& card = effect_.Card();
    const Eigen::VectorXd values = effect_.Parameters();
    ASSERT_EQ(values.size(), static_cast<Eigen::Index>(card.parameters.size()));
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      const ParameterCard& parameter = card.parameters[k];
      if (parameter.setting) continue;
      Eigen::VectorXd derivative = Eigen::VectorXd::Zero(size_);
      effect_.AddParameterDerivative(At(moving_.motion), static_cast<int>(k), &derivative);
      if (options_.without_influence.contains(parameter.name)) {
        EXPECT_EQ(derivative.norm(), 0) << "∂f/∂" << parameter.name << " was said to be zero";
        continue;
      }
      ASSERT_GT(derivative.norm(), 0) << "∂f/∂" << parameter.name << " is zero";
      const auto value = [&](double h) {
        return ForceWith(values + h * Eigen::VectorXd::Unit(values.size(), k));
      };
      const double unit =
          values[k] != 0 ? std::abs(values[k]) : parameter.plausible_max - parameter.plausible_min;
      EXPECT_LT(BestError(value, derivative, 0.1 * unit), options_.tolerance)
          << "∂f/∂" << parameter.name;
      const Eigen::VectorXd other = values + 0.1 * unit * Eigen::VectorXd::Unit(values.size(), k);
      EXPECT_EQ(effect_.WithParameters(other)->Parameters(), other) << parameter.name;
      EXPECT_EQ(effect_.Parameters(), values) << "an effect does not change";
      if (!std::isnan(parameter.null_value)) {
        Eigen::VectorXd at_null = values;
        at_null[k] = parameter.null_value;
        if (card.parameters.size() == 1 || k == 0) {
          EXPECT_LT(ForceWith(at_null).norm(), Force(moving_.motion).norm())
              << "the null value of " << parameter.name << " weakens the effect";
        }
      }
    }
  }

  // The internal variables at the end of the step.
  static Eigen::VectorXd AtEnd(const Effect& effect, const Kinematics& at) {
    Eigen::VectorXd state = at.state;
    effect.AdvanceState(at, &state);
    return state;
  }

  void CheckMemory() const {
    if (moving_.state.size() == 0) return;
    std::mt19937 random(options_.seed + 2);
    const double scale = moving_.state.lpNorm<Eigen::Infinity>();
    ASSERT_GT(scale, 0);
    const Eigen::MatrixXd changes = scale * Random(moving_.state.size(), &random);
    const Eigen::MatrixXd moved = 0.01 * Random(size_, &random);

    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(size_, 1);
    effect_.AddStateDerivatives(At(moving_.motion), changes, forces);
    const auto force = [&](double h) {
      const Eigen::VectorXd state = moving_.state + h * changes;
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(size_);
      effect_.AddForce(At(moving_.motion).WithState(state), &sum);
      return sum;
    };
    EXPECT_LT(BestError(force, Eigen::VectorXd(forces), 1), options_.tolerance) << "∂f/∂z";

    Eigen::MatrixXd at_end = changes;
    effect_.AdvanceStateDerivatives(At(moving_.motion), moved, at_end);
    const auto advanced = [&](double h) {
      const Motion shifted = Shifted(moving_.motion, {.position = h}, moved);
      const Eigen::VectorXd state = moving_.state + h * changes;
      return AtEnd(effect_, At(shifted).WithState(state));
    };
    EXPECT_LT(BestError(advanced, Eigen::VectorXd(at_end), 1), options_.tolerance)
        << "z at the end of the step";

    const EffectCard& card = effect_.Card();
    const Eigen::VectorXd values = effect_.Parameters();
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      if (card.parameters[k].setting) continue;
      Eigen::VectorXd derivative = Eigen::VectorXd::Zero(moving_.state.size());
      effect_.AddStateByParameter(At(moving_.motion), static_cast<int>(k), derivative);
      const auto value = [&](double h) {
        const auto other =
            effect_.WithParameters(values + h * Eigen::VectorXd::Unit(values.size(), k));
        return AtEnd(*other, At(moving_.motion));
      };
      const double unit = 0.1 * (values[k] != 0 ? std::abs(values[k]) : 1e-3);
      if (derivative.norm() == 0)
        EXPECT_EQ(value(1e-3 * unit), value(-1e-3 * unit)) << card.parameters[k].name;
      else
        EXPECT_LT(BestError(value, derivative, unit), options_.tolerance)
            << "∂z/∂" << card.parameters[k].name;
    }
  }

  // Derivatives by the parameters of the law that the effect refers to, at its own fixed force.
  void CheckElasticityDerivatives() const {
    if (options_.elasticity == nullptr) return;
    const Eigen::VectorXd values = options_.elasticity->Parameters();
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      Eigen::VectorXd derivative = Eigen::VectorXd::Zero(size_);
      effect_.AddElasticityDerivative(At(moving_.motion), static_cast<int>(k), &derivative);
      ASSERT_GT(derivative.norm(), 0) << "the force does not depend on the law";
      const auto value = [&](double h) {
        const auto law = options_.elasticity->WithParameters(
            values + h * Eigen::VectorXd::Unit(values.size(), k));
        Kinematics at = At(moving_.motion);
        at.elasticity = law.get();
        Eigen::VectorXd force = Eigen::VectorXd::Zero(size_);
        effect_.AddForce(at, &force);
        return force;
      };
      EXPECT_LT(BestError(value, derivative, 0.1 * values[k]), options_.tolerance)
          << "by parameter " << k << " of the elasticity law";
    }
  }

  // Sum of forces and of torques about the origin.
  void Resultants(const Eigen::VectorXd& force, Eigen::Vector3d* sum, Eigen::Vector3d* torque,
                  double* force_size, double* torque_size) const {
    sum->setZero();
    torque->setZero();
    *force_size = *torque_size = 0;
    for (Eigen::Index i = 0; i < size_ / 3; ++i) {
      const Eigen::Vector3d f = force.segment<3>(3 * i);
      const Eigen::Vector3d x = moving_.motion.position.segment<3>(3 * i);
      *sum += f;
      *torque += x.cross(f);
      *force_size += f.norm();
      *torque_size += x.norm() * f.norm();
    }
  }

  void CheckInvariances() const {
    const EffectCard& card = effect_.Card();
    const Eigen::VectorXd force = Force(moving_.motion);
    Eigen::Vector3d sum, torque;
    double force_size, torque_size;
    Resultants(force, &sum, &torque, &force_size, &torque_size);
    // Rounding of a few hundred additions.
    if (card.conserves_momentum) {
      EXPECT_LT(sum.norm(), 1e-12 * force_size) << "forces sum to zero";
    }
    if (!card.conserves_angular_momentum) return;
    EXPECT_LT(torque.norm(), 1e-12 * torque_size) << "torques sum to zero";

    // Seen from a frame turned, shifted and spinning, the forces are the same but turned.
    const Eigen::Matrix3d Q =
        Eigen::AngleAxisd(2.2, Eigen::Vector3d(0.3, 1, -0.7).normalized()).toRotationMatrix();
    const Eigen::Vector3d spin(4, -2, 3), shift(0.3, 0.1, -0.2);
    Motion seen{moving_.motion.position, moving_.motion.velocity, moving_.motion.acceleration};
    Eigen::VectorXd turned(size_);
    for (Eigen::Index i = 0; i < size_ / 3; ++i) {
      const Eigen::Vector3d x = Q * moving_.motion.position.segment<3>(3 * i);
      seen.position.segment<3>(3 * i) = x + shift;
      seen.velocity.segment<3>(3 * i) =
          Q * moving_.motion.velocity.segment<3>(3 * i) + spin.cross(x);
      turned.segment<3>(3 * i) = Q * force.segment<3>(3 * i);
    }
    // Positions of 0.3 m are known to 5e-17 m, strains of 0.02 m elements to 1e-14.
    EXPECT_LT((Force(seen) - turned).norm(), 1e-11 * force.norm())
        << "the same in a turned and spinning frame";
  }

  void CheckThreads() const {
    // Large enough that several threads find work.
    const MovingBody large = MakeMovingBody(effect_, order_, {7, 6, 5}, options_);
    const Motion& motion = large.motion;
    const Kinematics at{large.body,          motion.position,     motion.velocity,
                        motion.acceleration, options_.time,       options_.time_step,
                        large.state,         options_.elasticity,
                        /*has_inertia=*/true};
    const int threads = ThreadCount();
    Eigen::VectorXd force[2];
    BlockMatrix tangent[2] = {BlockMatrix(large.body.pattern), BlockMatrix(large.body.pattern)};
    for (const int k : {0, 1}) {
      SetThreadCount(1 + k);
      force[k] = Eigen::VectorXd::Zero(motion.position.size());
      effect_.AddForce(at, &force[k]);
      effect_.AddTangents(at, {1, 1, 1}, false, &tangent[k]);
      effect_.AddSkewTangents(at, {1, 1, 1}, &tangent[k]);
    }
    SetThreadCount(threads);
    EXPECT_EQ(force[0], force[1]);
    const int values = 9 * large.body.pattern->BlockCount();
    EXPECT_TRUE(std::equal(tangent[0].values(), tangent[0].values() + values, tangent[1].values()))
        << "the same tangent on one thread and on two";
  }

  const Effect& effect_;
  const CheckEffectOptions options_;
  const int order_;
  const MovingBody moving_;
  const Eigen::Index size_;
};

void CheckCard(const EffectCard& card) {
  EXPECT_FALSE(card.type.empty());
  for (const std::string* text : {&card.title, &card.equation, &card.citation,
                                  &card.residual_when_missing, &card.separating_experiment}) {
    EXPECT_GT(text->size(), 5u) << card.type << ": a field of the card is missing";
  }
  for (const ParameterCard& parameter : card.parameters) {
    EXPECT_FALSE(parameter.name.empty()) << card.type;
    EXPECT_GT(parameter.meaning.size(), 5u) << card.type << '.' << parameter.name;
    EXPECT_LT(parameter.plausible_min, parameter.plausible_max) << card.type;
    EXPECT_GE(parameter.plausible_min, parameter.bounds.min) << card.type;
    EXPECT_LE(parameter.plausible_max, parameter.bounds.max) << card.type;
  }
}

}  // namespace

Eigen::VectorXd ForceAt(const Effect& effect, const Body& body, const Eigen::VectorXd& position,
                        const Eigen::VectorXd& velocity) {
  const Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(position.size()), state;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(position.size());
  effect.AddForce({body, position, velocity, acceleration, 0, 0.01, state}, &force);
  return force;
}

void CheckEffect(const Effect* effect, const CheckEffectOptions& options) {
  CheckCard(effect->Card());
  for (const int order : {1, 2}) {
    SCOPED_TRACE(effect->Card().type + " on elements of order " + std::to_string(order));
    Checker(effect, order, options).Run();
  }
}

}  // namespace lacuna
