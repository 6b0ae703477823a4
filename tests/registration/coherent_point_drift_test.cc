#include "registration/coherent_point_drift.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "registration/warped_body.h"

namespace lacuna {
namespace {

constexpr int kPoints = 3000;

// Spacing of the clouds: √(area/points), with an area of about 0.031 m².
const double kSpacing = std::sqrt(0.031 / kPoints);

struct Errors {
  double all = 0.0;     // rms, m
  double normal = 0.0;  // rms of the part along the true normal, m
};

Errors ErrorsOf(const CpdResult& result, const PointCloud& source) {
  const Eigen::Matrix3Xd error = result.displaced - Warp(source.points);
  constexpr double kStep = 1e-6;
  double normal = 0.0;
  for (Eigen::Index i = 0; i < error.cols(); ++i) {
    Eigen::Matrix3Xd around(3, 3);
    const Eigen::Vector3d n = source.normals.col(i), a = n.unitOrthogonal(), b = n.cross(a);
    around << source.points.col(i), source.points.col(i) + kStep * a,
        source.points.col(i) + kStep * b;
    const Eigen::Matrix3Xd warped = Warp(around);
    const Eigen::Vector3d turned = Eigen::Vector3d(warped.col(1) - warped.col(0))
                                       .cross(Eigen::Vector3d(warped.col(2) - warped.col(0)))
                                       .normalized();
    normal += std::pow(turned.dot(error.col(i)), 2);
  }
  return {Rms(error), std::sqrt(normal / static_cast<double>(error.cols()))};
}

PointCloud Source(bool with_normals = false) {
  PointCloud source = SampleBody(kPoints, 1);
  if (!with_normals) source.normals.resize(3, 0);
  return source;
}

Errors Register(const ScanFaults& faults, bool with_normals = false) {
  const CpdResult result =
      RegisterNonrigid(Source(with_normals), ScanOfWarpedBody(kPoints, 2, faults));
  EXPECT_TRUE(result.IsUsable()) << result.message;
  return ErrorsOf(result, SampleBody(kPoints, 1));
}

double MotionSize() { return Rms(Warp(Source().points) - Source().points); }

// The tolerances are fractions of the point spacing, 3.2 mm; the motion is 2.6 spacings. The
// remaining error is tangential motion, which scans do not show.
TEST(CoherentPointDriftTest, RecoversAKnownWarp) {
  ASSERT_GT(MotionSize(), 1.0 * kSpacing);
  const Errors errors = Register({});
  EXPECT_LT(errors.all, 0.4 * kSpacing);
  EXPECT_LT(errors.normal, 0.03 * kSpacing);
}

TEST(CoherentPointDriftTest, RecoversItWithGivenNormals) {
  const Errors errors = Register({}, true);
  EXPECT_LT(errors.all, 0.4 * kSpacing);
  EXPECT_LT(errors.normal, 0.03 * kSpacing);
}

TEST(CoherentPointDriftTest, HasLessTangentialErrorThanPlainCpd) {
  const PointCloud source = Source(), target = ScanOfWarpedBody(kPoints, 2);
  CpdOptions plain;
  plain.tangential_weight = 1.0;
  plain.rigidity = 0.0;
  const CpdResult ours = RegisterNonrigid(source, target);
  const CpdResult theirs = RegisterNonrigid(source, target, plain);
  EXPECT_LT(Rms(ours.displaced - Warp(source.points)),
            0.7 * Rms(theirs.displaced - Warp(source.points)));
}

TEST(CoherentPointDriftTest, RecoversItThroughNoise) {
  ScanFaults faults;
  faults.noise = 0.5 * kSpacing;
  const Errors errors = Register(faults);
  EXPECT_LT(errors.all, 0.5 * kSpacing);
  EXPECT_LT(errors.normal, 0.15 * kSpacing);  // a third of the noise of a point
}

TEST(CoherentPointDriftTest, RecoversItAmongOutliers) {
  ScanFaults faults;
  faults.outliers = 0.2;
  const PointCloud source = Source();
  const PointCloud target = ScanOfWarpedBody(kPoints, 2, faults);
  const CpdResult result = RegisterNonrigid(source, target);
  const Errors errors = ErrorsOf(result, SampleBody(kPoints, 1));
  EXPECT_LT(errors.all, 0.45 * kSpacing);
  EXPECT_LT(errors.normal, 0.05 * kSpacing);
  // One in six points is an outlier; some of them lie on the body by chance.
  EXPECT_NEAR(result.outlier_weight, 1.0 / 6.0, 0.03);
  ASSERT_EQ(result.inlier.size(), target.Size());
  EXPECT_GT(result.inlier.head(kPoints).mean(), 0.97);
  EXPECT_LT(result.inlier.tail(kPoints / 5).mean(), 0.2);
}

TEST(CoherentPointDriftTest, RecoversItWithAPartMissingAndReportsWhere) {
  ScanFaults faults;
  faults.missing_beyond_x = 0.05;
  const PointCloud source = Source();
  const CpdResult result = RegisterNonrigid(source, ScanOfWarpedBody(kPoints, 2, faults));
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_LT(ErrorsOf(result, SampleBody(kPoints, 1)).all, 0.6 * kSpacing);
  double seen = 0.0, missing = 0.0;
  int seen_count = 0, missing_count = 0;
  for (int i = 0; i < kPoints; ++i) {
    if (source.points(0, i) < 0.04) seen += result.weight[i], ++seen_count;
    if (source.points(0, i) > 0.065) missing += result.weight[i], ++missing_count;
  }
  ASSERT_GT(missing_count, 50);
  EXPECT_NEAR(seen / seen_count, 1.0, 0.1);
  EXPECT_LT(missing / missing_count, 0.05);
}

TEST(CoherentPointDriftTest, RecoversTheInverseWithSwappedRoles) {
  const PointCloud body = SampleBody(kPoints, 2);
  PointCloud warped;
  warped.points = Warp(body.points);
  const CpdResult result = RegisterNonrigid(warped, Source());
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_LT(Rms(result.displaced - body.points), 0.4 * kSpacing);
}

TEST(CoherentPointDriftTest, TangentialWeightOfOneFollowsTrackedPoints) {
  const PointCloud source = Source();
  PointCloud target;
  target.points = Warp(source.points);
  CpdOptions options;
  options.tangential_weight = 1.0;
  options.rigidity = 0.0;
  options.sigma_floor = 0.1;
  const CpdResult result = RegisterNonrigid(source, target, options);
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_LT(Rms(result.displaced - target.points), 0.02 * kSpacing);
}

TEST(CoherentPointDriftTest, TheFieldIsThatOfTheDisplacedPoints) {
  const PointCloud source = Source();
  const CpdResult result = RegisterNonrigid(source, ScanOfWarpedBody(kPoints, 2));
  const Eigen::Matrix3Xd evaluated = source.points + result.field.Evaluate(source.points);
  // The difference between single and double precision.
  EXPECT_LT((evaluated - result.displaced).cwiseAbs().maxCoeff(), 1e-4 * kSpacing);
  // The field is as accurate between the points as at them.
  const PointCloud between = SampleBody(500, 7);
  EXPECT_LT(Rms(between.points + result.field.Evaluate(between.points) - Warp(between.points)),
            0.4 * kSpacing);
}

TEST(CoherentPointDriftTest, DoesNotDependOnTheUnitOrThePlace) {
  const PointCloud source = Source(), target = ScanOfWarpedBody(kPoints, 2);
  const CpdResult here = RegisterNonrigid(source, target);
  const Eigen::Vector3d offset(30.0, -20.0, 10.0);
  PointCloud far_source, far_target;
  far_source.points = (1000.0 * source.points).colwise() + offset;
  far_target.points = (1000.0 * target.points).colwise() + offset;
  const CpdResult there = RegisterNonrigid(far_source, far_target);
  // Rounding of the coordinates may change a comparison and with it an iteration.
  EXPECT_LT(Rms((there.displaced.colwise() - offset) / 1000.0 - here.displaced), 0.01 * kSpacing);
}

TEST(CoherentPointDriftTest, IsBitIdenticalForOneAndTwoThreads) {
  const PointCloud source = Source(), target = ScanOfWarpedBody(kPoints, 2);
  const int threads = ThreadCount();
  SetThreadCount(1);
  const CpdResult one = RegisterNonrigid(source, target);
  SetThreadCount(2);
  const CpdResult two = RegisterNonrigid(source, target);
  SetThreadCount(threads);
  EXPECT_EQ(one.displaced, two.displaced);
  EXPECT_EQ(one.weight, two.weight);
  EXPECT_EQ(one.field.Evaluate(source.points), two.field.Evaluate(source.points));
  EXPECT_EQ(one.field.StandardDeviation(source.points), two.field.StandardDeviation(source.points));
}

TEST(CoherentPointDriftTest, AgreesBetweenInstructionSets) {
  const PointCloud source = Source(), target = ScanOfWarpedBody(kPoints, 2);
  CpdOptions options;
  options.kernels = &KernelsFor(InstructionSet::kBaseline);
  const CpdResult baseline = RegisterNonrigid(source, target, options);
  for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (!IsSupported(set)) continue;
    options.kernels = &KernelsFor(set);
    const CpdResult result = RegisterNonrigid(source, target, options);
    // The iteration stops when it moves by 0.004 spacings; rounding changes that point slightly.
    EXPECT_LT(Rms(result.displaced - baseline.displaced), 2e-3 * kSpacing);
  }
}

TEST(CoherentPointDriftTest, StandardDeviationMatchesTheErrorAndGrowsWithoutData) {
  ScanFaults faults;
  faults.missing_beyond_x = 0.04;
  faults.noise = 0.1 * kSpacing;
  const PointCloud source = Source();
  const CpdResult result = RegisterNonrigid(source, ScanOfWarpedBody(kPoints, 2, faults));
  const Eigen::Matrix3Xd error = result.displaced - Warp(source.points);
  const Eigen::VectorXd deviation = result.field.StandardDeviation(source.points);
  double error_seen = 0.0, predicted_seen = 0.0, predicted_missing = 0.0;
  int seen = 0, missing = 0;
  for (int i = 0; i < kPoints; ++i) {
    if (source.points(0, i) < 0.03) {
      error_seen += error.col(i).squaredNorm();
      predicted_seen += deviation[i] * deviation[i];
      ++seen;
    } else if (source.points(0, i) > 0.06) {
      predicted_missing += deviation[i] * deviation[i];
      ++missing;
    }
  }
  // The errors of one field are strongly correlated, so their mean square has few degrees of
  // freedom: allow a factor of four either way.
  EXPECT_LT(std::sqrt(error_seen / seen), 4.0 * std::sqrt(predicted_seen / seen));
  EXPECT_GT(std::sqrt(error_seen / seen), 0.25 * std::sqrt(predicted_seen / seen));
  EXPECT_GT(std::sqrt(predicted_missing / missing), 1.2 * std::sqrt(predicted_seen / seen));
  // Far away only the prior is known.
  EXPECT_GT(result.field.StandardDeviation(Eigen::Vector3d(2.0, 2.0, 2.0))[0],
            2.0 * deviation.maxCoeff());
}

TEST(CoherentPointDriftTest, AWarmStartNeedsFewerIterations) {
  const PointCloud source = Source(), target = ScanOfWarpedBody(kPoints, 2);
  const CpdResult cold = RegisterNonrigid(source, target);
  const CpdResult warm = RegisterNonrigid(source, target, {}, &cold.field);
  ASSERT_TRUE(warm.IsUsable()) << warm.message;
  // It skips the coarse level, but σ still has to converge.
  EXPECT_LE(4 * warm.iterations, 3 * cold.iterations);
  EXPECT_LT(Rms(warm.displaced - cold.displaced), 0.05 * kSpacing);
}

TEST(CoherentPointDriftTest, ReportsThatIterationsRanOut) {
  CpdOptions options;
  options.max_iterations = 1;
  const CpdResult result = RegisterNonrigid(Source(), ScanOfWarpedBody(kPoints, 2), options);
  EXPECT_EQ(result.status, CpdStatus::kNoConvergence);
  EXPECT_FALSE(result.IsUsable());
  EXPECT_TRUE(result.displaced.allFinite());
}

CpdStatus StatusOf(const PointCloud& source, const PointCloud& target) {
  const CpdResult result = RegisterNonrigid(source, target);
  EXPECT_NE(result.message, "not run");
  EXPECT_EQ(result.IsUsable(), result.status == CpdStatus::kConverged);
  return result.status;
}

TEST(CoherentPointDriftTest, UnusableInputGetsItsStatus) {
  const PointCloud good = SampleBody(200, 1);
  PointCloud one, nan = good, infinite = good, together = good, line = good;
  one.points = Eigen::Vector3d(0.0, 0.0, 0.0);
  nan.points(1, 7) = std::numeric_limits<double>::quiet_NaN();
  infinite.points(2, 9) = std::numeric_limits<double>::infinity();
  together.points.colwise() = Eigen::Vector3d(0.1, 0.2, 0.3);
  line.points.bottomRows(2).setZero();
  EXPECT_EQ(StatusOf({}, good), CpdStatus::kTooFewPoints);
  EXPECT_EQ(StatusOf(good, {}), CpdStatus::kTooFewPoints);
  EXPECT_EQ(StatusOf(one, good), CpdStatus::kTooFewPoints);
  EXPECT_EQ(StatusOf(good, one), CpdStatus::kTooFewPoints);
  EXPECT_EQ(StatusOf(nan, good), CpdStatus::kNotFinite);
  EXPECT_EQ(StatusOf(good, infinite), CpdStatus::kNotFinite);
  EXPECT_EQ(StatusOf(together, good), CpdStatus::kNoExtent);
  EXPECT_EQ(StatusOf(line, good), CpdStatus::kNoExtent);
}

TEST(CoherentPointDriftTest, IdenticalCloudsStayInPlace) {
  const PointCloud source = Source();
  const CpdResult result = RegisterNonrigid(source, source);
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_LT(Rms(result.displaced - source.points), 0.01 * kSpacing);
}

TEST(CoherentPointDriftTest, TargetsInOnePlaceDoNotCrash) {
  PointCloud together = Source();
  together.points.colwise() = Eigen::Vector3d(0.1, 0.0, 0.0);
  const CpdResult result = RegisterNonrigid(Source(), together);
  EXPECT_TRUE(result.displaced.allFinite());
}

TEST(CoherentPointDriftTest, ChecksTheRangesOfItsOptions) {
  const auto run = [](auto member, auto value) {
    CpdOptions options;
    options.*member = value;
    RegisterNonrigid({}, {}, options);
  };
  EXPECT_DEATH(run(&CpdOptions::beta, 0.0), "options.beta");
  EXPECT_DEATH(run(&CpdOptions::sigma_floor, 0.0), "options.sigma_floor");
  EXPECT_DEATH(run(&CpdOptions::tangential_weight, 1.5), "options.tangential_weight");
  EXPECT_DEATH(run(&CpdOptions::rank_tolerance, -1.0), "options.rank_tolerance");
  EXPECT_DEATH(run(&CpdOptions::max_iterations, 0), "options.max_iterations");
}

}  // namespace
}  // namespace lacuna
