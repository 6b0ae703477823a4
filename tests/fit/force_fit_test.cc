#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/parallel.h"
#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "fit/coefficient_fit.h"
#include "fit/position_fit.h"
#include "fit/step_force_fitter.h"
#include "geometry/embedding.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

// A clamped bar of 100 × 30 × 30 mm: the truth on a fine quadratic mesh, or the model on another
// mesh.
struct Bar {
  std::shared_ptr<Body> body;
  Model model;
  Eigen::VectorXi tip;
};

Bar MakeBar(const std::array<int, 3>& cells, int order) {
  Bar bar;
  bar.body = std::make_shared<Body>(MakeBody(
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0.03, 0.03), cells, order), 1000));
  std::vector<int> clamped, tip;
  for (int i = 0; i < bar.body->NodeCount(); ++i) {
    if (bar.body->mesh.nodes(0, i) < 1e-9) clamped.push_back(i);
    if (bar.body->mesh.nodes(0, i) > 0.1 - 1e-9) tip.push_back(i);
  }
  const Eigen::VectorXi held = Eigen::Map<Eigen::VectorXi>(clamped.data(), clamped.size());
  bar.tip = Eigen::Map<Eigen::VectorXi>(tip.data(), tip.size());
  bar.model = {bar.body,
               {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})},
               {Grip{held, {}}}};
  return bar;
}

Eigen::Matrix3Xd AsPoints(const Eigen::VectorXd& stacked) {
  return Eigen::Map<const Eigen::Matrix3Xd>(stacked.data(), 3, stacked.size() / 3);
}

// A scan of the truth under a force at its tip: surface points with noise.
struct Truth {
  PointCloud scan;
  Eigen::Vector3d force;
};
constexpr double kNoise = 1e-4;  // m

// The surface of the truth at rest and under a force at its tip.
struct Surfaces {
  TriMesh rest, loaded;
};

Surfaces LoadBar(const Eigen::Vector3d& force) {
  const Bar bar = MakeBar({14, 5, 4}, 2);
  MotionHistory history = RestHistory(bar.model);
  StepOptions options;
  options.scheme = TimeScheme::kQuasiStatic;
  const Eigen::VectorXd load = FootprintForce(*bar.body, bar.tip, 1.0).basis * force;
  EXPECT_TRUE(Stepper(bar.model, options).Equilibrium(load, &history).IsUsable());
  return {bar.body->boundary.surface, BoundaryAt(bar.body->boundary, AsPoints(history.position))};
}

Truth ScanLoadedBar(const Eigen::Vector3d& force) {
  const TriMesh surface = LoadBar(force).loaded;
  Truth truth{EvaluateSamples(surface, SampleSurface(surface, 3000, 5)), force};
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, kNoise);
  for (Eigen::Index j = 0; j < truth.scan.Size(); ++j)
    truth.scan.points.col(j) += noise(random) * truth.scan.normals.col(j);
  return truth;
}

// Fits to the scan alone with eight updates of the correspondences, as the reconstruction does.
ForceFit FitToScan(const Bar& bar, const ForceModel& forces, const PointCloud& scan,
                   const Eigen::VectorXd& start_position) {
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  ForceFit fit;
  StepForceFitter fitter(bar.model, equation, forces, start_position);
  Eigen::VectorXd position = start_position;
  for (int round = 0; round < 8; ++round) {
    const Observations seen =
        ObserveScan(bar.body->boundary, AsPoints(position), scan, kNoise, /*reach=*/0.05);
    fit = fitter.Fit(seen);
    if (!fit.IsUsable()) return fit;
    position = fit.position;
  }
  return fit;
}

ForceFit FitToScan(const Bar& bar, const ForceModel& forces, const PointCloud& scan) {
  return FitToScan(bar, forces, scan, RestHistory(bar.model).position);
}

TEST(ForceFit, RecoversAKnownForceOnAnotherMesh) {
  const Truth truth = ScanLoadedBar({0.02, 0.06, -0.15});
  const Bar bar = MakeBar({7, 3, 2}, 2);
  const ForceFit fit = FitToScan(bar, FootprintForce(*bar.body, bar.tip, 0.3), truth.scan);
  ASSERT_TRUE(fit.IsUsable()) << fit.message;
  const NetForce net = NetForceOf(fit.force, fit.position, Eigen::Vector3d::Zero());
  // The coarser mesh is about 1 % stiffer. The axial component has little effect and is less
  // certain.
  EXPECT_NEAR(net.force.z(), truth.force.z(), 0.03 * 0.15);
  EXPECT_NEAR(net.force.y(), truth.force.y(), 0.03 * 0.15);
  EXPECT_NEAR(net.force.x(), truth.force.x(), 0.3 * 0.15);
  EXPECT_LT(fit.weighted_rms, 1.3);  // noise, and the flat faces of the coarse mesh
  EXPECT_LE(fit.factorisations, 12);
}

// The standard deviations of the components of the net force, N.
Eigen::Vector3d FitDeviation(const Bar& bar, const ForceModel& forces, const ForceFit& fit,
                             const PointCloud& scan) {
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const Observations seen =
      ObserveScan(bar.body->boundary, AsPoints(fit.position), scan, kNoise, /*reach=*/0.05);
  return NetForceDeviation(
      forces, StepForceFitter(bar.model, equation, forces, fit.position).Covariance(fit, seen));
}

TEST(ForceFit, GivesTheStandardDeviationOfTheForce) {
  // The mean square error of the net force of a smooth field, in units of its standard deviation,
  // would have the expectation 1 if the true forces were drawn from the prior. The prior allows
  // them anywhere on the surface, also near the clamp, where they hardly move anything and the
  // deviation is that of the prior. The true force acts at the tip alone, so that the error is
  // smaller: the mean is 0.07. With deviations 2.1 times too large it would be 0.016, with
  // deviations 2.1 times too small 0.31.
  const Bar bar = MakeBar({7, 3, 2}, 2);
  const ForceModel forces = SmoothForces(*bar.body, bar.body->boundary.node, 0.03, 300);
  double squares = 0;
  int count = 0;
  for (const Eigen::Vector3d& force : {Eigen::Vector3d(0, 0.05, -0.1), Eigen::Vector3d(0.1, 0, 0.1),
                                       Eigen::Vector3d(0, -0.1, 0), Eigen::Vector3d(0, 0, 0)}) {
    const Truth truth = ScanLoadedBar(force);
    const ForceFit fit = FitToScan(bar, forces, truth.scan);
    ASSERT_TRUE(fit.IsUsable()) << fit.message;
    const Eigen::Vector3d deviation = FitDeviation(bar, forces, fit, truth.scan);
    const NetForce net = NetForceOf(fit.force, fit.position, Eigen::Vector3d::Zero());
    squares += ((net.force - force).array() / deviation.array()).square().sum();
    count += 3;
  }
  EXPECT_LT(squares / count, 0.3);
  EXPECT_GT(squares / count, 0.02);
}

TEST(ForceFit, AStepUnderTheFittedForcesReachesTheFittedPositions) {
  const Truth truth = ScanLoadedBar({0, 0, -0.1});
  const Bar bar = MakeBar({6, 2, 2}, 2);
  const ForceFit fit = FitToScan(bar, FootprintForce(*bar.body, bar.tip, 0.3), truth.scan);
  ASSERT_TRUE(fit.IsUsable()) << fit.message;
  MotionHistory history = RestHistory(bar.model);
  StepOptions options;
  options.scheme = TimeScheme::kQuasiStatic;
  ASSERT_TRUE(Stepper(bar.model, options).Equilibrium(fit.force, &history).IsUsable());
  // Both solve the same equation, to 1e-8 of the acting forces.
  EXPECT_LT((history.position - fit.position).lpNorm<Eigen::Infinity>(), 1e-7);
}

TEST(ForceFit, SmoothAndFreeForcesFollowTheScanToItsNoise) {
  const Truth truth = ScanLoadedBar({0, 0.05, -0.1});
  const Bar bar = MakeBar({7, 3, 3}, 1);
  const Eigen::VectorXi& surface = bar.body->boundary.node;
  const ForceFit smooth = FitToScan(bar, SmoothForces(*bar.body, surface, 0.03, 3e3), truth.scan);
  ASSERT_TRUE(smooth.IsUsable()) << smooth.message;
  EXPECT_LT(smooth.weighted_rms, 1.3);
  // A scan without correspondences does not determine free forces, so they start close to the
  // solution, as in a sequence.
  const ForceFit free = FitToScan(bar, FreeForces(*bar.body, surface), truth.scan, smooth.position);
  ASSERT_TRUE(free.IsUsable()) << free.message;
  EXPECT_LT(free.weighted_rms, 1.2);
}

TEST(ForceFit, IsTheSameForOneAndTwoThreads) {
  const Truth truth = ScanLoadedBar({0, 0, -0.1});
  const Bar bar = MakeBar({5, 2, 2}, 1);
  const int threads = ThreadCount();
  SetThreadCount(1);
  const ForceFit one = FitToScan(bar, FreeForces(*bar.body, bar.body->boundary.node), truth.scan);
  SetThreadCount(2);
  const ForceFit two = FitToScan(bar, FreeForces(*bar.body, bar.body->boundary.node), truth.scan);
  SetThreadCount(threads);
  EXPECT_EQ(one.force, two.force);
}

TEST(ForceFit, BothFormulationsFindTheSameForces) {
  const Truth truth = ScanLoadedBar({0, 0.05, -0.1});
  const Bar bar = MakeBar({6, 2, 2}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  // Forces at gripped nodes have no effect, and only the formulation by elimination reports them.
  std::vector<int> loaded;
  for (const int node : bar.body->boundary.node)
    if (bar.body->mesh.nodes(0, node) > 1e-9) loaded.push_back(node);
  const ForceModel forces =
      SmoothForces(*bar.body, Eigen::Map<Eigen::VectorXi>(loaded.data(), loaded.size()), 0.05, 300);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(forces.CoefficientCount());
  const Eigen::VectorXd no_force = Eigen::VectorXd::Zero(rest.position.size());
  const Observations seen =
      ObserveScan(bar.body->boundary, bar.body->mesh.nodes, truth.scan, kNoise, /*reach=*/0.05);
  ForceFitOptions options;
  options.function_tolerance = 1e-12;
  options.immaterial_decrease = 0;
  options.max_iterations = 200;
  const ForceFit eliminated =
      CoefficientFitter(bar.model, equation, forces, ControlForces(bar.model, forces),
                        rest.position, zero)
          .Fit(seen, {no_force, zero}, options);
  ASSERT_TRUE(eliminated.IsUsable()) << eliminated.message;
  PositionFitStart start{rest.position, zero, no_force};
  ForceFit sparse;
  for (int round = 0; round < 4; ++round) {  // until the multiplier has converged
    sparse = FitPositions(bar.model, equation, forces, seen, start, {no_force, zero}, options);
    ASSERT_TRUE(sparse.IsUsable()) << sparse.message;
    start = {sparse.position, sparse.coefficients, sparse.multiplier};
  }
  // A thousandth of the noise and of the largest force.
  EXPECT_LT((sparse.position - eliminated.position).lpNorm<Eigen::Infinity>(), 1e-3 * kNoise);
  EXPECT_LT((sparse.force - eliminated.force).lpNorm<Eigen::Infinity>(),
            1e-3 * eliminated.force.lpNorm<Eigen::Infinity>());
}

// Four nodes of the tip, which are free.
Eigen::VectorXi TipCorners(const Bar& bar) {
  std::vector<int> corners;
  for (const int node : bar.tip) {
    const Eigen::Vector3d at = bar.body->mesh.nodes.col(node);
    const bool is_edge_y = std::abs(at.y() - 0.015) > 0.0149;
    const bool is_edge_z = std::abs(at.z() - 0.015) > 0.0149;
    if (is_edge_y && is_edge_z) corners.push_back(node);
  }
  return Eigen::Map<Eigen::VectorXi>(corners.data(), corners.size());
}

TEST(ForceFit, PlacesAndForcesAsUnknownsFindTheSameForces) {
  const Truth truth = ScanLoadedBar({0, 0.05, -0.1});
  const Bar bar = MakeBar({6, 2, 2}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const ForceModel forces = NodalForces(*bar.body, TipCorners(bar), 0.05);
  ASSERT_EQ(forces.CoefficientCount(), 12);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(forces.CoefficientCount());
  const Eigen::VectorXd no_force = Eigen::VectorXd::Zero(rest.position.size());
  const Observations seen =
      ObserveScan(bar.body->boundary, bar.body->mesh.nodes, truth.scan, kNoise, /*reach=*/0.05);
  ForceFitOptions options;
  options.function_tolerance = 1e-12;
  options.immaterial_decrease = 0;
  std::unique_ptr<BalanceControl> places = ControlPlaces(bar.model, equation, forces);
  ASSERT_NE(places, nullptr);
  const ForceFit by_places =
      CoefficientFitter(bar.model, equation, forces, std::move(places), rest.position, zero)
          .Fit(seen, {no_force, zero}, options);
  const ForceFit by_forces =
      CoefficientFitter(bar.model, equation, forces, ControlForces(bar.model, forces),
                        rest.position, zero)
          .Fit(seen, {no_force, zero}, options);
  ASSERT_TRUE(by_places.IsUsable()) << by_places.message;
  ASSERT_TRUE(by_forces.IsUsable()) << by_forces.message;
  EXPECT_NEAR(by_places.final_cost, by_forces.final_cost, 1e-6 * by_forces.final_cost);
  EXPECT_LT((by_places.position - by_forces.position).lpNorm<Eigen::Infinity>(), 1e-2 * kNoise);
  EXPECT_LT((by_places.force - by_forces.force).lpNorm<Eigen::Infinity>(),
            1e-3 * by_forces.force.lpNorm<Eigen::Infinity>());
}

TEST(ForceFit, PlacesAreNoUnknownsWhereAForceActsOnSeveralNodesOrOnAHeldOne) {
  const Bar bar = MakeBar({3, 2, 2}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const auto has_places = [&](const ForceModel& forces) {
    return ControlPlaces(bar.model, equation, forces) != nullptr;
  };
  EXPECT_TRUE(has_places(NodalForces(*bar.body, bar.tip, 1)));
  EXPECT_FALSE(has_places(FootprintForce(*bar.body, bar.tip, 1)));
  EXPECT_FALSE(has_places(NodalForces(*bar.body, bar.body->boundary.node, 1)));
}

TEST(ForceFit, FollowsAFarMotionOfASoftBodyInOneStep) {
  // The tip of a bar of 100 mm moves by 76 mm at once, and the bar bends by more than 60°.
  const Surfaces truth = LoadBar({0.3, 1.4, -2});
  const auto samples = SampleSurface(truth.rest, 300, 5);
  const Eigen::Matrix3Xd before = EvaluateSamples(truth.rest, samples).points;
  const Eigen::Matrix3Xd after = EvaluateSamples(truth.loaded, samples).points;
  const Bar bar = MakeBar({6, 2, 2}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const ForceModel forces = NodalForces(*bar.body, bar.tip, 0.5);
  const Embedding places = Embed(bar.body->mesh, before);
  const Observations seen = ObserveMarkers(bar.body->mesh, places, after, kNoise);
  const ForceFit fit = StepForceFitter(bar.model, equation, forces, rest.position).Fit(seen);
  ASSERT_TRUE(fit.IsUsable()) << fit.message;
  const Eigen::Matrix3Xd found = PointsAt(places, bar.body->mesh, AsPoints(fit.position));
  const double farthest = (after - before).colwise().norm().maxCoeff();
  EXPECT_GT(farthest, 0.07);
  EXPECT_LT((found - after).colwise().norm().mean(), 0.01 * farthest);
  EXPECT_LE(fit.factorisations, 40);
}

// The prior alone determines the force then, and its residual is none of an observation.
TEST(ForceFit, HasNoResidualOfObservationsWithoutAny) {
  const Bar bar = MakeBar({3, 1, 1}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const ForceModel forces = FootprintForce(*bar.body, bar.tip, 0.01);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const Eigen::VectorXd no_force = Eigen::VectorXd::Zero(rest.position.size());
  const ForceFitPrior prior{no_force, Eigen::Vector3d::UnitX()};
  const Observations nothing =
      ObserveScan(bar.body->boundary, bar.body->mesh.nodes, {}, 1e-4, 0.01);
  ASSERT_EQ(nothing.Count(), 0);
  const ForceFit eliminated =
      CoefficientFitter(bar.model, equation, forces, ControlForces(bar.model, forces),
                        rest.position, zero)
          .Fit(nothing, prior, {});
  ASSERT_TRUE(eliminated.IsUsable()) << eliminated.message;
  EXPECT_NEAR(eliminated.coefficients[0], 1, 1e-2);
  EXPECT_EQ(eliminated.weighted_rms, 0);
  const ForceFit sparse = FitPositions(bar.model, equation, forces, nothing,
                                       {rest.position, zero, no_force}, prior, {});
  EXPECT_EQ(sparse.weighted_rms, 0);
}

TEST(ForceFit, ReportsMissingUnknownsAndObservations) {
  const Bar bar = MakeBar({3, 1, 1}, 1);
  const MotionHistory rest = RestHistory(bar.model);
  const StepEquation equation(bar.model, rest, TimeScheme::kQuasiStatic, 0);
  const Observations nothing = ObserveScan(bar.body->boundary, bar.body->mesh.nodes,
                                           {Eigen::Matrix3Xd::Constant(3, 5, 9.0), {}}, 1e-4, 0.01);
  EXPECT_EQ(nothing.Count(), 0);
  const ForceModel free = FreeForces(*bar.body, bar.body->boundary.node);
  EXPECT_EQ(StepForceFitter(bar.model, equation, free, rest.position).Fit(nothing).status,
            ForceFit::Status::kNothingObserved);
  const ForceModel none = NoForces(*bar.body);
  EXPECT_EQ(StepForceFitter(bar.model, equation, none, rest.position).Fit(nothing).status,
            ForceFit::Status::kNoUnknowns);
}

}  // namespace
}  // namespace lacuna
