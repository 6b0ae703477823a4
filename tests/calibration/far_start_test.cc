// A bar that hangs from one end, deeply bent already in the only frame, seen from one side.
#include "calibration/far_start.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_problem.h"
#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "prediction/prediction_study_reader.h"
#include "scan/scan_writer.h"
#include "support/held_bar.h"
#include "support/silent_fit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

constexpr double kYoungModulus = 2e4;  // Pa
constexpr double kLength = 0.08;       // m

// The hanging bar. Its mesh differs from the study's in all directions, but is about as stiff: the
// error of coarse elements, which exceeds the interval here, is not what is tested.
TriMesh HangingBar(double gravity_z) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({11, 3, 3}, 2), 1000));
  model.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", kYoungModulus}, {"poisson_ratio", 0.4}}),
      MakeEffect("gravity", {{"acceleration_z", gravity_z}})};
  model.grips = {
      {NodesWhere(model.body->mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  TriMesh surface;
  const PredictionSummary summary =
      Predict(model, options, {0}, {}, [&](int, const PredictedState& state) {
        surface = BoundaryAt(model.body->boundary,
                             state.position.reshaped(3, model.body->mesh.NodeCount()));
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  return surface;
}

// One depth camera looks along y, nearly at right angles to the plane in which the bar bends: most
// of what it sees is one face, whose outline alone tells how far the bar hangs down. The recording
// is displaced by `shift`.
void WriteView(const std::filesystem::path& folder, TriMesh surface,
               const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  surface.vertices.colwise() += shift;
  CameraRing ring;
  ring.center = {0.03, 0, -0.02};
  ring.radius = 0.3;
  ring.up = Eigen::Vector3d::UnitY();
  ring.elevation = 1.3;
  ring.field_of_view = 0.5;
  ScannerOptions options;
  options.noise = 2e-4;
  RecordedObject object;
  object.density = 1000;
  WriteScan(folder, "hanging", object, {{surface}, {0}, {PlaceCameras(ring)[0]}, options},
            WritePointFrames);
  std::ofstream(folder / "recording.yaml", std::ios::app)
      << "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
         "reference: {from: mesh, file: box.off}\n";
  WriteBox(folder / "box.off");
}

PredictionStudy StudyFrom(const std::filesystem::path& folder, double start,
                          const std::string& recording_options = "") {
  return ReadPredictionStudy(
      Config::Parse(fmt::format(R"(schema_version: 1
name: hanging
mesh: {{max_volume: 60 mm^3, order: 2}}
material: {{law: neo_hookean, young_modulus: {} Pa, poisson_ratio: 0.4}}
effects: [{{type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}}]
motion: {{scheme: quasi_static, time_step: 1 s}}
scan: {{patches: 80, shape_deviation: 0.3 mm}}
fit: {{parameters: [{{name: young_modulus}}]}}
recordings:
  - recording: {}
{})",
                                start, (folder / "recording.yaml").string(), recording_options),
                    (folder / "study.yaml").string()));
}

// That of the study.
TetMesh HangingBarMesh() { return BarMesh({14, 2, 2}, 2); }

class HangingBarView : public testing::Test {
 protected:
  static const TriMesh& Surface() {
    static const TriMesh surface = HangingBar(-9.80665);
    return surface;
  }
  TemporaryFolder folder_;
};

// Or a start with another modulus would not be far from it.
TEST_F(HangingBarView, SagsByMoreThanHalfOfItsLength) {
  EXPECT_LT(Surface().vertices.row(2).minCoeff(), -0.01 - 0.55 * kLength);
}

TEST_F(HangingBarView, DeterminesTheModulusFromFarStarts) {
  WriteView(folder_.Path(), Surface());
  for (const double start : {0.25 * kYoungModulus, 3.5 * kYoungModulus, 20 * kYoungModulus}) {
    const PredictionStudy study = StudyFrom(folder_.Path(), start);
    const CalibrationProblem problem(study, HangingBarMesh());
    const FarStart far = FindFarStart(problem, problem.Start());
    EXPECT_THAT(far.summary, HasSubstr("times their start values")) << start;
    const Calibration fit = FitSilently(problem);
    ASSERT_TRUE(fit.usable) << fit.message;
    const ParameterEstimate& modulus = fit.estimates[0];
    EXPECT_EQ(modulus.determination, Determination::kPinnedDown);
    EXPECT_LT(modulus.low, kYoungModulus) << start;
    EXPECT_GT(modulus.high, kYoungModulus) << start;
    // The pixels at the outline are half a millimetre wide.
    EXPECT_NEAR(modulus.value, kYoungModulus, 0.02 * kYoungModulus) << start;
    EXPECT_LT(modulus.high - modulus.low, 0.05 * kYoungModulus) << start;
  }
}

// One prediction shows that the start is near the solution; no other values are tried.
TEST_F(HangingBarView, IsNotSearchedFromNearby) {
  WriteView(folder_.Path(), Surface());
  const PredictionStudy study = StudyFrom(folder_.Path(), 1.02 * kYoungModulus);
  const CalibrationProblem problem(study, HangingBarMesh());
  const FarStart far = FindFarStart(problem, problem.Start());
  EXPECT_EQ(far.values, problem.Start());
  EXPECT_EQ(far.summary, "");
  EXPECT_EQ(far.reach_factor, 1);
  EXPECT_EQ(far.predictions, 1);
}

// The pose of the camera is not exactly known: the modulus and the displacement of the scan follow
// from the same points.
TEST_F(HangingBarView, DeterminesModulusAndRegistration) {
  const Eigen::Vector3d shift(0.001, -0.002, 0.0015);
  WriteView(folder_.Path(), Surface(), shift);
  const PredictionStudy study =
      StudyFrom(folder_.Path(), 3.5 * kYoungModulus,
                "    registration: {shift_deviation: 2 mm, turn_deviation: 0.2 deg}\n");
  const CalibrationProblem problem(study, HangingBarMesh());
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  ASSERT_EQ(fit.estimates.size(), 7u);
  EXPECT_LT(fit.estimates[0].low, kYoungModulus);
  EXPECT_GT(fit.estimates[0].high, kYoungModulus);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(fit.estimates[static_cast<size_t>(1 + axis)].low, shift[axis]) << axis;
    EXPECT_GT(fit.estimates[static_cast<size_t>(1 + axis)].high, shift[axis]) << axis;
  }
}

// A scan of a bar that was bent upwards cannot be reached by a model that hangs downwards.
TEST_F(HangingBarView, SaysWhyAScanCannotBeReached) {
  WriteView(folder_.Path(), HangingBar(9.80665));
  const PredictionStudy study = StudyFrom(folder_.Path(), kYoungModulus);
  const CalibrationProblem problem(study, HangingBarMesh());
  const Calibration fit = FitSilently(problem);
  EXPECT_FALSE(fit.usable);
  EXPECT_THAT(fit.message, HasSubstr("most scanned points are farther than scan.reach"));
  EXPECT_THAT(fit.message, HasSubstr("times their start values the scanned points are at best"));
}

// A scan in metres that was declared to be in millimetres lies inside the object.
TEST_F(HangingBarView, SaysThatAScanIsTooSmall) {
  TriMesh tiny = Surface();
  tiny.vertices *= 0.1;
  tiny.vertices.row(0).array() += 0.03;
  tiny.vertices.row(1).array() += 0.01;
  WriteView(folder_.Path(), tiny);
  const PredictionStudy study = StudyFrom(folder_.Path(), 30 * kYoungModulus);
  const CalibrationProblem problem(study, HangingBarMesh());
  const Calibration fit = FitSilently(problem);
  EXPECT_FALSE(fit.usable);
  EXPECT_THAT(fit.message, HasSubstr("patches of the predicted surface: the length unit"));
}

}  // namespace
}  // namespace lacuna
