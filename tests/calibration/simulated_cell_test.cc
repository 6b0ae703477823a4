// A load cell with a tare and a delay, as `lacuna simulate` plays it, in a fit.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "calibration/calibration_problem.h"
#include "calibration/held_out_misfit.h"
#include "calibration/reaction_report.h"
#include "geometry/mesh_io.h"
#include "prediction/played_recording.h"
#include "prediction/predicted_body.h"
#include "support/pulled_bar.h"
#include "support/silent_fit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr double kTare = 0.08;  // N
constexpr double kDelay = 0.4;  // s
constexpr double kTruth = 1e5;  // Pa

// A jaw that goes back and forth: while a force grows evenly, a delay cannot be told from a tare.
void WriteSwayingJaw(const std::filesystem::path& file) {
  std::ofstream path(file);
  path << "t,x,y,z,rx,ry,rz\n";
  for (int k = 0; k <= 300; ++k) {
    const double time = 0.05 * k;
    path << time << "," << 0.0025 * (1 - std::cos(2 * std::numbers::pi * time / 10))
         << ",0,0,0,0,0\n";
  }
}

TEST(SimulatedCell, ItsTareAndDelayAreRecoveredByAFit) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {},
                 "{file: force.csv, time: t, x: fx, unit: N, deviation: 10 mN, tare_deviation: "
                 "0.3 N, delay_deviation: 1 s}");
  WriteSwayingJaw(folder / "jaw.csv");
  const PredictionStudy truth = ReadPulledBarStudy(
      folder.Path(),
      {{"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
       {"    fit_until: 11.5 s\n",
        "    simulated_cells:\n      - {part: jaw, tare: [0.08 N, 0, 0], delay: 0.4 s}\n"}});
  const TetMesh mesh = PulledBarMesh();
  const auto body = std::make_shared<const Body>(MakeBody(mesh, truth.density));
  const PredictedRecording& item = truth.recordings.front();
  const RecordingModel model(truth, item, mesh, body, {});
  const PlayedRecording played = Play(model, PlayedNuisances(model));
  ASSERT_TRUE(played.summary.IsUsable()) << played.summary.message;
  MarkerRecording recording = AsRecording(item, played, truth.noise, 1);
  std::filesystem::create_directories(folder / "played");
  WriteTetMesh(folder / "played/object.msh", mesh);
  recording.reference = folder / "played/object.msh";
  WriteMarkerRecording(folder / "played", recording);

  const PredictionStudy study = ReadPulledBarStudy(folder / "played");
  EXPECT_TRUE(study.recordings.front().simulated_cells.empty());
  const CalibrationProblem problem(study, mesh);
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  ASSERT_EQ(fit.estimates.size(), 2u);
  EXPECT_NE(problem.parameters()[1].name.find("jaw.force_delay"), std::string::npos);
  // The force changes by about 2.3 N while the jaw moves by 5 mm, and by 0.5 N/s, so that twelve
  // readings of 10 mN give the modulus to 0.3 %, the delay to 6 ms and the tare to 5 mN. The
  // tolerances are at least five times as large.
  EXPECT_NEAR(fit.estimates[0].value, kTruth, 0.03 * kTruth);
  EXPECT_NEAR(fit.estimates[1].value, kDelay, 0.05);
  EXPECT_LT(fit.estimates[1].high - fit.estimates[1].low, 0.1);
  // The tare is predicted minus measured.
  EXPECT_NEAR(MisfitsOf(problem, fit.parameters).at(0).reactions.at(0).tare.at(0), -kTare, 0.03);
  EXPECT_LT(fit.rms, 1.2);
  // The curve of the report has the displacement at the time of the reading. The path is linear
  // between points that are 0.05 s apart, which is off by 0.3 µm.
  const CsvTable curve =
      ReactionTable(problem, MisfitsOf(problem, fit.parameters), /*torques=*/false);
  for (const int frame : {3, 8}) {
    const double time = frame - fit.estimates[1].value;
    EXPECT_NEAR(curve.at(6).values[frame],
                0.0025 * (1 - std::cos(2 * std::numbers::pi * time / 10)), 1e-6);
  }
}

}  // namespace
}  // namespace lacuna
