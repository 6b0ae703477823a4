// A body that is led along a path of given deformations, for tests of effects with memory.
#ifndef LACUNA_SUPPORT_STRAINED_BODY_H_
#define LACUNA_SUPPORT_STRAINED_BODY_H_

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

#include "fem/effect.h"
#include "support/box_mesh.h"

namespace lacuna {

class StrainedBody {
 public:
  explicit StrainedBody(std::shared_ptr<const Effect> effect, int order = 1)
      : effect_(std::move(effect)),
        body_(MakeBody(BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {2, 1, 1}, order), 1000)),
        state_(effect_->StateSize(body_)) {
    effect_->InitialState(body_, &state_);
  }

  const Body& body() const { return body_; }
  const Eigen::VectorXd& state() const { return state_; }

  // The nodal forces at the end of a step that leads to `position`; the memory then is that of the
  // end.
  Eigen::VectorXd Move(const Eigen::VectorXd& position, double time_step) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(position.size());
    const Kinematics at{body_, position, zero, zero, 0, time_step, state_};
    Eigen::VectorXd force = zero;
    effect_->AddForce(at, &force);
    Eigen::VectorXd end = state_;
    effect_->AdvanceState(at, &end);
    state_ = end;
    return force;
  }

  // The first Piola–Kirchhoff stress at the end of a step that leads to the homogeneous deformation
  // F: P = −Σ f_a X_aᵀ / V, as Σ_a g_a X_aᵀ = I.
  Eigen::Matrix3d Deform(const Eigen::Matrix3d& F, double time_step) {
    const Eigen::VectorXd position = (F * body_.mesh.nodes).reshaped();
    const Eigen::VectorXd force = Move(position, time_step);
    return -force.reshaped(3, body_.NodeCount()) * body_.mesh.nodes.transpose() /
           body_.weight.sum();
  }

  // The stress q of a branch with Q = diag(q, 0, 0) at the end of a step that leads to the strain
  // B = diag(ε, 0, 0) of fem/branch_strain.h, where the stretch s along x and t across it have
  // s² − t² = 2ε and s t² = 1 + ε.
  double StretchBranch(double strain, double time_step) {
    double stretch = 1;
    for (int k = 0; k < 100; ++k) {
      const double value = stretch * (stretch * stretch - 2 * strain) - (1 + strain);
      stretch -= value / (3 * stretch * stretch - 2 * strain);
    }
    const double across = std::sqrt(stretch * stretch - 2 * strain);
    const Eigen::Matrix3d P =
        Deform(Eigen::Vector3d(stretch, across, across).asDiagonal(), time_step);
    // P₁₁ = s (q − q/3) + (q/3) t²
    return P(0, 0) / (2 * stretch / 3 + across * across / 3);
  }

  // The work that it takes to lead all nodes once around a random closed path, by the trapezoidal
  // rule, J. The largest strains are about `strain`; more than 1 inverts elements.
  double WorkOfACycle(double strain, double duration, unsigned seed) {
    constexpr int kSteps = 400, kHarmonics = 3;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const Eigen::VectorXd rest = body_.mesh.nodes.reshaped();
    Eigen::MatrixXd shape(rest.size(), 2 * kHarmonics);
    for (double& value : shape.reshaped()) value = 0.002 * strain * uniform(random);
    Eigen::VectorXd position = rest, force = Move(rest, duration / kSteps);
    double work = 0;
    for (int n = 1; n <= kSteps; ++n) {
      Eigen::VectorXd next = rest;
      for (int k = 0; k < kHarmonics; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 1) * n / kSteps;
        next += std::sin(angle) * shape.col(2 * k) + (1 - std::cos(angle)) * shape.col(2 * k + 1);
      }
      const Eigen::VectorXd next_force = Move(next, duration / kSteps);
      work -= 0.5 * (force + next_force).dot(next - position);
      position = next;
      force = next_force;
    }
    return work;
  }

 private:
  std::shared_ptr<const Effect> effect_;
  Body body_;
  Eigen::VectorXd state_;
};

}  // namespace lacuna

#endif  // LACUNA_SUPPORT_STRAINED_BODY_H_
