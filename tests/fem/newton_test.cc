#include "fem/newton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "support/box_mesh.h"
#include "support/test_effect.h"

namespace lacuna {
namespace {

constexpr double kWidth = 1e-3;      // m
constexpr double kStiffness = 1000;  // N/m

// A potential well along x for node 0, E = k w² (1 − exp(−u²/2w²)), whose tangent is not positive
// beyond u = w, not even the convexified one. Springs hold the node along y and z.
class Well final : public TestEffect<Well> {
 public:
  static constexpr const char* kType = "well";
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    (*force)[0] -= kStiffness * Offset(at) * Decay(at);
  }
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool,
                   BlockMatrix* tangent) const override {
    const double u = Offset(at) / kWidth;
    tangent->Block(tangent->pattern().diagonal[0]).diagonal() -=
        weights.position * kStiffness * Eigen::Vector3d((1 - u * u) * Decay(at), 1, 1);
  }
  std::optional<double> Energy(const Kinematics& at) const override {
    return kStiffness * kWidth * kWidth * (1 - Decay(at));
  }

 private:
  static double Offset(const Kinematics& at) { return at.position[0] - at.body.mesh.nodes(0, 0); }
  static double Decay(const Kinematics& at) {
    return std::exp(-0.5 * std::pow(Offset(at) / kWidth, 2));
  }
};

// The well with node 0 free along x and all others held, in statics.
struct WellProblem {
  Model model;
  MotionHistory history;
  Eigen::VectorXd no_force;
  HeldComponents held;

  WellProblem() : held({}) {
    model.body =
        std::make_shared<const Body>(MakeBody(BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), 1000));
    model.effects = {std::make_shared<Well>()};
    history = RestHistory(model);
    no_force = Eigen::VectorXd::Zero(history.position.size());
    std::vector<AxisSet> axes(static_cast<size_t>(model.body->NodeCount()), AxisSet::All());
    axes[0] = AxisSet::Of(1) | AxisSet::Of(2);
    held = HeldComponents(axes);
  }

  // Solves from `offset` (m) along x.
  NewtonSummary Solve(double offset, int max_iterations, double* solution) const {
    const StepEquation equation(model, history, TimeScheme::kQuasiStatic, 0);
    LinearSolver solver(model.body->pattern, held, {});
    BlockMatrix tangent(model.body->pattern);
    Eigen::VectorXd position = history.position;
    position[0] += offset;
    const NewtonSummary summary = SolveByNewton({equation, no_force, held, 1e-9, max_iterations},
                                                history.position, &solver, &tangent, &position);
    *solution = position[0] - history.position[0];
    return summary;
  }
};

// The first full step, u − u/(1 − u²) in widths, ends at −1.5 where the potential is higher and
// the tangent negative, so that no step can be taken from there. A line search from the start
// then finds the well.
TEST(Newton, HasNoMessageAfterAFailedAttemptFromWhichItRecovers) {
  double solution = 0;
  const NewtonSummary summary = WellProblem().Solve(0.81 * kWidth, 50, &solution);
  EXPECT_EQ(summary.status, NewtonSummary::Status::kConverged) << summary.message;
  EXPECT_EQ(summary.message, "");
  EXPECT_LT(std::abs(solution), 1e-9 * kWidth);
  EXPECT_GE(summary.iterations, 3);  // the line search, the attempt before it, and the end
}

TEST(Newton, SaysWhyItFails) {
  double solution = 0;
  NewtonSummary summary = WellProblem().Solve(2 * kWidth, 50, &solution);
  EXPECT_EQ(summary.status, NewtonSummary::Status::kLinearSolverFailed);
  EXPECT_NE(summary.message.find("not positive definite"), std::string::npos) << summary.message;
  EXPECT_NE(summary.message.find("largest residual"), std::string::npos) << summary.message;
  EXPECT_EQ(solution, 2 * kWidth);
  summary = WellProblem().Solve(0.5 * kWidth, 1, &solution);
  EXPECT_EQ(summary.status, NewtonSummary::Status::kNoConvergence);
  EXPECT_NE(summary.message.find("no convergence in 1 iteration"), std::string::npos)
      << summary.message;
}

}  // namespace
}  // namespace lacuna
