#include "calibration/data_shares.h"

#include <gtest/gtest.h>

#include <optional>

#include "support/pulled_bar.h"
#include "support/scanned_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(SharesOfData, SumToOneOverMarkersAndForces) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {});
  const PredictionStudy study = ReadPulledBarStudy(
      folder.Path(), {{"{name: young_modulus}", "{name: young_modulus}, {name: poisson_ratio}"}});
  const CalibrationProblem problem(study, PulledBarMesh());
  const auto shares = SharesOfData(problem, problem.Start());
  ASSERT_EQ(shares.size(), 2u);
  for (const std::optional<DataShares>& one : shares) {
    ASSERT_TRUE(one);
    EXPECT_EQ(one->scans, 0);
    EXPECT_NEAR(one->markers + one->forces, 1, 1e-12);  // rounding
  }
  // The markers do not see the modulus of a bar that is stretched by a given length, and see how
  // much thinner it becomes.
  EXPECT_LT(shares[0]->markers, 1e-3);
  EXPECT_GT(shares[1]->markers, 0.01);
}

TEST(SharesOfData, TellMarkersFromScans) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  WriteBarScans(
      folder / "scans", HeldBarSurfaces({}),
      "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
      "reference: {from: mesh, file: box.off}\n");
  const std::string scans =
      "recordings:\n  - recording: scans/recording.yaml\n    name: scans\n    fit_until: 0.2001 s\n"
      "    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n"
      "      release: 0.0437 s\n";
  const PredictionStudy study = ReadBarStudy(folder.Path(), {{"recordings:\n", scans}});
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 1));
  const auto shares = SharesOfData(problem, problem.Start());
  ASSERT_EQ(shares.size(), problem.parameters().size());
  for (size_t k = 0; k < 2; ++k) {  // the modulus and the damping, which both recordings show
    ASSERT_TRUE(shares[k]);
    EXPECT_GT(shares[k]->markers, 0);
    EXPECT_GT(shares[k]->scans, 0);
    EXPECT_EQ(shares[k]->forces, 0);
    EXPECT_NEAR(shares[k]->markers + shares[k]->scans, 1, 1e-12);
  }
  // The forces that hold the bar belong to one recording each, the scans first.
  ASSERT_TRUE(shares[2]);
  EXPECT_NEAR(shares[2]->scans, 1, 1e-12);
  ASSERT_TRUE(shares[5]);
  EXPECT_NEAR(shares[5]->markers, 1, 1e-12);

  const PredictionStudy alone = ReadBarStudy(folder.Path());
  const CalibrationProblem markers(alone, BarMesh({6, 2, 2}, 1));
  EXPECT_TRUE(SharesOfData(markers, markers.Start()).empty()) << "there is one kind of data";
}

}  // namespace
}  // namespace lacuna
