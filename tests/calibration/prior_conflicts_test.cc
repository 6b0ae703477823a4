// Conflicts of made-up misfits with the priors of a study. Nothing is simulated.
#include "calibration/prior_conflicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <variant>

#include "prediction/prediction_study_reader.h"
#include "support/scanned_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr double kPlaceDeviation = 2e-4;  // m, of the study
constexpr Eigen::Index kClock = 3;        // the nuisance parameter after the force of the hold
constexpr double kClockDeviation = 0.01;  // s

class MarkerConflictsOfABar : public testing::Test {
 protected:
  MarkerConflictsOfABar() {
    Eigen::Matrix3Xd moved = BarMarkerPlaces();
    moved.row(1).array() += 0.003;
    std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
    frames[kFrames / 3] = moved;
    WriteBarRecording(folder_.Path(), frames);
    study_ = ReadBarStudy(folder_.Path());
    misfit_.name = "bar";
    misfit_.nuisance = Eigen::VectorXd::Zero(kClock + 1);
    misfit_.place_offset = Eigen::Matrix3Xd::Zero(3, kMarkers);
  }
  std::vector<PriorConflict> Conflicts() const {
    const CalibrationProblem problem(study_, BarMesh({2, 1, 1}, 1));
    return FindPriorConflicts(problem, problem.Start(), {misfit_});
  }
  // Conflicts where the fit estimates these values, SI, of Young's modulus and the mass damping.
  std::vector<PriorConflict> ConflictsAt(double young_modulus, double alpha) const {
    const CalibrationProblem problem(study_, BarMesh({2, 1, 1}, 1));
    Eigen::VectorXd values = problem.Start();
    values.head<2>() << young_modulus, alpha;
    return FindPriorConflicts(problem, values, {misfit_});
  }

  TemporaryFolder folder_;
  PredictionStudy study_;
  RecordingMisfit misfit_;
};

// P(χ²_1 > 3²) = 0.0027, and P(χ²_3 > 4.31²) is an eighth of it.
TEST_F(MarkerConflictsOfABar, BeginBeyondThreeDeviationsOfANumberAndFurtherOutForEightPlaces) {
  misfit_.nuisance[kClock] = -2.9 * kClockDeviation;
  misfit_.place_offset(1, 2) = 4.25 * kPlaceDeviation;
  EXPECT_TRUE(Conflicts().empty());

  misfit_.nuisance[kClock] = -3.1 * kClockDeviation;
  misfit_.place_offset(1, 2) = -4.4 * kPlaceDeviation;
  const std::vector<PriorConflict> conflicts = Conflicts();
  ASSERT_EQ(conflicts.size(), 2u);
  const auto& clock = std::get<NuisanceParameterConflict>(conflicts[0]);
  EXPECT_EQ(clock.parameter, "bar.clock");
  EXPECT_NEAR(clock.deviations, 3.1, 1e-12);
  const auto& marker = std::get<MarkerConflict>(conflicts[1]);
  EXPECT_EQ(marker.recording, "bar");
  EXPECT_EQ(marker.marker, "m2");
  EXPECT_EQ(marker.offset, misfit_.place_offset.col(2));
  EXPECT_DOUBLE_EQ(marker.deviation, kPlaceDeviation);

  misfit_.has_own_places = false;  // the other recording reports them
  EXPECT_EQ(Conflicts().size(), 1u);
}

// The plausible range of the mass damping is 0 to 20 1/s in the reference body, so that its prior
// there is 1 ± 10 1/s.
TEST_F(MarkerConflictsOfABar, IncludeAParameterFarFromItsDefaultPrior) {
  const double deviation =
      10 * std::sqrt(1.5) * (kReferenceBody.length / study_.recordings[0].recording.size);
  EXPECT_TRUE(ConflictsAt(0.15e6, 1 + 2.99 * deviation).empty());
  const std::vector<PriorConflict> conflicts = ConflictsAt(0.15e6, 1 + 3.2 * deviation);
  ASSERT_EQ(conflicts.size(), 1u);
  const auto& damping = std::get<ModelParameterConflict>(conflicts[0]);
  EXPECT_EQ(damping.parameter, "mass_damping.alpha");
  EXPECT_EQ(damping.unit, "1/s");
  EXPECT_NEAR(damping.deviations, 3.2, 1e-12);
  EXPECT_EQ(damping.mean, 1);
  EXPECT_TRUE(damping.is_default);
}

// The modulus is fitted on a logarithmic scale, on which the prior is ln(0.1 MPa) ± 0.2.
TEST_F(MarkerConflictsOfABar, MeasureAParameterOnTheScaleOnWhichItIsFitted) {
  study_ = ReadBarStudy(
      folder_.Path(),
      {{"{name: young_modulus}", "{name: young_modulus, mean: 0.1 MPa, deviation: 20 kPa}"}});
  EXPECT_TRUE(ConflictsAt(1e5 * std::exp(-0.58), 1).empty());
  const std::vector<PriorConflict> conflicts = ConflictsAt(1e5 * std::exp(-0.7), 1);
  ASSERT_EQ(conflicts.size(), 1u);
  const auto& modulus = std::get<ModelParameterConflict>(conflicts[0]);
  EXPECT_EQ(modulus.parameter, "young_modulus");
  EXPECT_NEAR(modulus.deviations, 3.5, 1e-9);
  EXPECT_DOUBLE_EQ(modulus.mean, 1e5);
  EXPECT_FALSE(modulus.is_default);
}

TEST_F(MarkerConflictsOfABar, ListTheSixWorstMarkersAndCountTheOthers) {
  for (int m = 1; m < kMarkers; ++m) misfit_.place_offset(0, m) = (4 + m) * kPlaceDeviation;
  const std::vector<PriorConflict> conflicts = Conflicts();
  ASSERT_EQ(conflicts.size(), 7u);
  EXPECT_EQ(std::get<MarkerConflict>(conflicts[0]).marker, "m7");
  EXPECT_EQ(std::get<MarkerConflict>(conflicts[5]).marker, "m2");
  const auto& count = std::get<MarkerConflictCount>(conflicts[6]);
  EXPECT_EQ(count.conflicting, 7);
  EXPECT_EQ(count.markers, kMarkers);
}

// Places of many markers that obey their prior: with a limit of 3 standard deviations for each, 2.9
// % of them would be reported, i.e. some marker in a fifth of all recordings of 8 markers.
TEST_F(MarkerConflictsOfABar, AreRareWhereThePriorHolds) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, kPlaceDeviation);
  const CalibrationProblem problem(study_, BarMesh({2, 1, 1}, 1));
  int reported = 0;
  for (int trial = 0; trial < 300; ++trial) {
    misfit_.place_offset =
        Eigen::Matrix3Xd::NullaryExpr(3, kMarkers, [&] { return normal(random); });
    reported += !FindPriorConflicts(problem, problem.Start(), {misfit_}).empty();
  }
  EXPECT_LT(reported, 6);  // 0.8 ± 0.9
}

// Tracked points, whose places are those of the first frame, off the shape that was given.
TEST_F(MarkerConflictsOfABar, SayWhereTrackedPointsAreOffTheGivenShape) {
  Recording& recording = study_.recordings[0].recording;
  const Eigen::Matrix3Xd on_shape = recording.markers.places;
  PointFrames tracked;
  tracked.tracked = true;
  recording.frames = tracked;
  const auto conflicts_at = [&](double distance) {
    recording.markers.places = on_shape;
    recording.markers.places.row(2).array() += distance;
    return Conflicts();
  };
  EXPECT_TRUE(conflicts_at(2.9 * kPlaceDeviation).empty());
  const std::vector<PriorConflict> conflicts = conflicts_at(3.1 * kPlaceDeviation);
  ASSERT_EQ(conflicts.size(), 1u);
  const auto& shape = std::get<ReferenceShapeConflict>(conflicts[0]);
  EXPECT_EQ(shape.frame, 0);
  EXPECT_NEAR(shape.rms, 3.1 * kPlaceDeviation, 1e-9);
}

// Two scans of the bar at rest.
void WriteRestingBar(const std::filesystem::path& folder) {
  const TriMesh surface = MakeBody(BarMesh({4, 1, 1}, 1), 1000).boundary.surface;
  CameraRing ring;
  ring.center = {0.04, 0, 0};
  ring.radius = 0.25;
  ring.up = Eigen::Vector3d::UnitX();  // so that both ends are seen
  ring.elevation = 0.6;
  ring.width = 60;
  ring.height = 45;
  ring.field_of_view = 0.6;
  RecordedObject object;
  object.density = 1000;
  WriteScan(folder, "bar", object, {{surface, surface}, {0, 0.1}, PlaceCameras(ring), {}},
            WritePointFrames);
  std::ofstream(folder / "recording.yaml", std::ios::app)
      << "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
         "reference: {from: mesh, file: box.off}\n";
  WriteBox(folder / "box.off");
}

TEST(ScanConflictsOfABar, AreOffsetPatchesAndScansThatWereNotCompared) {
  const TemporaryFolder folder;
  WriteRestingBar(folder.Path());
  const PredictionStudy study =
      ReadPredictionStudy(Config::Parse(R"(schema_version: 1
name: bar
mesh: {max_volume: 1000 mm^3}
material: {law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
motion: {scheme: quasi_static, time_step: 1 s}
scan: {patches: 20, shape_deviation: 0.3 mm, noise: 0.4 mm}
fit: {parameters: [{name: young_modulus}]}
recordings: [{recording: recording.yaml}]
)",
                                        (folder / "study.yaml").string()));
  const CalibrationProblem problem(study, BarMesh({4, 1, 1}, 1));
  RecordingMisfit misfit;
  misfit.name = "bar";
  misfit.place_offset = Eigen::RowVectorXd::Constant(20, 0.8e-3);
  misfit.misfit.frames = {0, 1};
  misfit.misfit.observed.resize(2);
  for (Observed& observed : misfit.misfit.observed) observed.offered = observed.used = 100;
  EXPECT_TRUE(FindPriorConflicts(problem, problem.Start(), {misfit}).empty());

  misfit.place_offset(0, 7) = -1.1e-3;  // 3.7 deviations
  EXPECT_TRUE(FindPriorConflicts(problem, problem.Start(), {misfit}).empty());

  misfit.place_offset(0, 7) = -1.2e-3;
  misfit.misfit.observed[1].used = 80;
  const std::vector<PriorConflict> conflicts =
      FindPriorConflicts(problem, problem.Start(), {misfit});
  ASSERT_EQ(conflicts.size(), 2u);
  const auto& patches = std::get<PatchConflict>(conflicts[0]);
  EXPECT_EQ(patches.conflicting, 1);
  EXPECT_EQ(patches.patches, 20);
  EXPECT_EQ(patches.largest, 1.2e-3);
  EXPECT_DOUBLE_EQ(patches.deviation, 3e-4);
  const auto& scans = std::get<UnmatchedScans>(conflicts[1]);
  EXPECT_EQ(scans.unmatched, 1);
  EXPECT_EQ(scans.frames, 2);
  EXPECT_DOUBLE_EQ(scans.first_time, 0.1);
}

}  // namespace
}  // namespace lacuna
