#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <utility>

#include "calibration/adaptive_time_step.h"
#include "diagnosis/loaded_bar.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"

namespace lacuna {
namespace {

TEST_F(LoadedBar, IsFittedInAStepAFrame) {
  PredictionStudy study = Record({});
  EXPECT_EQ(study.time_step, 1);
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_EQ(study.time_step, 1);  // nothing depends on rates
  EXPECT_LT(fit.step_error, 0.01);
  EXPECT_NEAR(fit.calibration.parameters[0], kModulus, 0.02 * kModulus);
  EXPECT_NEAR(fit.calibration.parameters[1], kRatio, 0.05);
  EXPECT_LT(fit.calibration.rms, 1.2);
}

// A bed under a part of the bar, whose modulus, place and size are fitted on another mesh.
TEST_F(LoadedBar, RecoversAPartlySupportedSide) {
  PredictionStudy study = Record(
      {BedBelow()},
      "fit: {parameters: [{name: young_modulus}, {name: elastic_support.modulus}, "
      "{name: elastic_support.point_x, min: 0 m, max: 0.08 m}, {name: elastic_support.radius, "
      "min: 3 mm, max: 40 mm}]}\n",
      ", {type: elastic_support, modulus: 30 kPa/m, side: [0, 0, -1], point: [35 mm, 0 m, -10 mm], "
      "radius: 15 mm}");
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_LT(fit.calibration.rms, 1.3);
  const Eigen::VectorXd& found = fit.calibration.parameters;
  EXPECT_NEAR(found[0], kModulus, 0.03 * kModulus);
  // Modulus times the square of the radius is what a bed this short is known by.
  EXPECT_NEAR(found[1] * found[3], 1.5e5 * 0.009, 0.1 * 1.5e5 * 0.009);
  // The place and the radius trade off (the correlation is 0.97): the interval of the place is 28
  // mm wide.
  EXPECT_NEAR(found[2], 0.047, 0.006);
  for (const auto& [k, truth] : {std::pair(2, 0.047), std::pair(3, 0.009)}) {
    EXPECT_LT(fit.calibration.estimates[k].low, truth) << k;
    EXPECT_GT(fit.calibration.estimates[k].high, truth) << k;
  }
}

// A strain without stress, which the moduli of the model do not change: both are found.
TEST_F(LoadedBar, RecoversASwellingAndPoissonsRatio) {
  PredictionStudy study = Record({MakeEffect("swelling", {{"strain", 0.03}})},
                                 "fit: {parameters: [{name: young_modulus}, {name: poisson_ratio}, "
                                 "{name: swelling.strain}]}\n",
                                 ", {type: swelling, strain: 0}");
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_LT(fit.calibration.rms, 1.3);
  EXPECT_NEAR(fit.calibration.parameters[0], kModulus, 0.03 * kModulus);
  // Bending shows Poisson's ratio no better without the swelling (IsFittedInAStepAFrame).
  EXPECT_NEAR(fit.calibration.parameters[1], kRatio, 0.05);
  EXPECT_NEAR(fit.calibration.parameters[2], 0.03, 0.0005);
  const ParameterEstimate& strain = fit.calibration.estimates[2];
  EXPECT_LT(std::abs(strain.correlation), 0.5) << "independent of the moduli";
  EXPECT_LT(strain.high - strain.low, 0.004);
}

// Points of an image correlation are as good as markers.
TEST_F(LoadedBar, ComesAsTrackedPointsToo) {
  Record({});
  for (int k = 0; k < kLoads; ++k) {
    std::ofstream points(folder_ / fmt::format("points_{:02}.csv", k));
    points << "x,y,z\n";
    const Eigen::Matrix3Xd places = BarMarkerPlaces().array() + 1e-3 * k;
    for (const auto& point : places.colwise())
      points << fmt::format("{},{},{}\n", point.x(), point.y(), point.z());
    points << (k == 5 ? "nan,nan,nan\n" : "0.04,0.01,0\n");  // lost in one frame
  }
  std::string text = FileContent(folder_ / "recording.yaml");
  const size_t frames = text.find("frames:"), fixed = text.find("fixed:");
  text.replace(frames, fixed - frames,
               "frames: {kind: points, pattern: points_%02d.csv, count: 16, rate: 1 Hz, "
               "tracked: true, columns: {x: x, y: y, z: z}}\n");
  text.replace(text.find("fixed: [{name"), 13, "gripped: [{follows: scan, name");
  std::ofstream(folder_ / "recording.yaml") << text;
  EXPECT_THAT([&] { Experiment(""); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("region \"clamp\"")));
  text.replace(text.find("point: [0.002 m"), 15, "point: [0.025 m");
  std::ofstream(folder_ / "recording.yaml") << text;
  const PredictionStudy study = Experiment("");
  const PredictedRecording& item = study.recordings[0];
  EXPECT_EQ(item.scans, nullptr);
  ASSERT_EQ(item.recording.markers.names.size(), 9u);
  EXPECT_EQ(item.recording.markers.names[8], "p8");
  EXPECT_TRUE(item.recording.markers.places.leftCols(8).isApprox(BarMarkerPlaces(), 1e-9));
  EXPECT_TRUE(item.recording.markers.positions[5].col(8).array().isNaN().all());
  EXPECT_EQ(item.recording.markers.positions[4](0, 8), 0.04);
  EXPECT_EQ(item.recording.object.grips[0].motion, GripMotion::kFollowsMarkers);
  EXPECT_EQ(PlaceDeviation(study, item, 2e-5), 1e-4) << "given in the experiment";
  PredictionStudy without = study;
  without.place_deviation_is_given = false;
  EXPECT_EQ(PlaceDeviation(without, item, 2e-5), 2e-5) << "the noise of the frame that shows them";
  EXPECT_THAT(item.recording.object.grips[0].markers, testing::ElementsAre("p0", "p1"));
}

}  // namespace
}  // namespace lacuna
