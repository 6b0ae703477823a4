#include "diagnosis/removed_misfit.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace lacuna {
namespace {

constexpr int kObservedFrames = 4;
constexpr double kMarkerNoise = 1e-4, kForceNoise = 0.01;  // m, N

// A recording of one marker with a load cell along one axis, whose residuals are the same in all
// frames. A unit of the adopted nuisance adds `nuisance` to all of them, in m and in N.
FittedHypothesis MakeHypothesis(double marker_residual, double force_residual,
                                double nuisance = 0) {
  FittedHypothesis hypothesis;
  LinearisedMisfit& misfit = hypothesis.misfit;
  misfit.usable = true;
  for (const bool is_force : {false, true}) {
    LinearisedMisfit::Part part;
    part.layout.series = is_force ? 1 : 3;
    for (int frame = 0; frame < kObservedFrames; ++frame) part.layout.times.push_back(0.01 * frame);
    part.layout.count.assign(static_cast<size_t>(part.layout.Rows()), 1);
    part.errors.noise = is_force ? kForceNoise : kMarkerNoise;
    part.fitted.assign(kObservedFrames, 1);
    if (is_force) part.reaction = 0;
    if (is_force) part.first_row = misfit.parts[0].layout.Rows();
    misfit.parts.push_back(part);
  }
  misfit.residual.resize(4 * kObservedFrames);
  misfit.residual << Eigen::VectorXd::Constant(3 * kObservedFrames, marker_residual),
      Eigen::VectorXd::Constant(kObservedFrames, force_residual);
  misfit.jacobian = Eigen::MatrixXd::Constant(4 * kObservedFrames, 1, nuisance);
  hypothesis.priors = {{0, 1, false}};
  return hypothesis;
}

const std::vector<DataKind> kKinds{&ByDataKind::markers, &ByDataKind::forces};

TEST(RemovedMisfit, IsCountedForEachKindOfData) {
  const ByDataKind removed = RemovedMisfit(MakeHypothesis(2e-4, 0.03), MakeHypothesis(3e-4, 0.01),
                                           NoiseLevel{0, 1}, kKinds);
  // 12 coordinates go from 2 σ to 3 σ, and 4 forces from 3 σ to σ; tolerances are for rounding.
  EXPECT_NEAR(removed.markers, 12 * (4 - 9), 1e-9);
  EXPECT_NEAR(removed.forces, 4 * (9 - 1), 1e-9);
  EXPECT_EQ(removed.scans, 0);
}

TEST(RemovedMisfit, SumsToTheDifferenceOfTheMisfitsThatEvidenceRestsOn) {
  const NoiseLevel noise{0.008, 1.3};
  // The nuisance can follow the markers alone: 1e-3 N are a tenth of σ.
  const FittedHypothesis before = MakeHypothesis(2e-4, 0.03, 1e-3);
  const FittedHypothesis after = MakeHypothesis(1e-4, 0.02, 1e-3);
  const ByDataKind removed = RemovedMisfit(before, after, noise, kKinds);
  const double misfit = EvidenceOf(before, noise).misfit;
  // Rounding.
  EXPECT_NEAR(removed.markers + removed.forces, misfit - EvidenceOf(after, noise).misfit,
              1e-9 * misfit);
  const ByDataKind without =
      RemovedMisfit(MakeHypothesis(2e-4, 0.03), MakeHypothesis(1e-4, 0.02), noise, kKinds);
  EXPECT_LT(std::abs(removed.markers),
            0.1 * without.markers);  // the nuisance removes nearly all of it
}

}  // namespace
}  // namespace lacuna
