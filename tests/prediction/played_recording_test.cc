// The recording of a held bar, played with the model that made it but for its mesh and its step.
#include "prediction/played_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
#include "support/pulled_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class PlayingARecording : public ::testing::Test {
 protected:
  PlayingARecording() {
    HeldBarTruth truth;
    truth.noise = truth.clock = 0;
    filmed_ = FilmHeldBar(truth);
    WriteBarRecording(folder_.Path(), filmed_);
  }
  PredictionStudy Study(const std::string& force) const {
    return ReadBarStudy(folder_.Path(), {{"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
                                         {"alpha: 1 1/s", "alpha: 2 1/s"},
                                         {"order: 2", "order: 2, preserve_surface: false"},
                                         {"      release:", force + "      release:"}});
  }

  TemporaryFolder folder_;
  std::vector<Eigen::Matrix3Xd> filmed_;
};

TEST_F(PlayingARecording, ShowsWhatWasFilmed) {
  const PredictionStudy study = Study("      force: [0 N, 0.05 N, 0.02 N]\n");
  const TetMesh mesh = MakeReferenceBody(study).mesh;
  const auto body = std::make_shared<const Body>(MakeBody(mesh, study.density));
  const PredictedRecording& item = study.recordings.front();
  const RecordingModel model(study, item, mesh, body, {});
  // The fit starts with the force, and its prior is still about 0.
  EXPECT_EQ(model.nuisances()[1].prior.start, 0.05);
  EXPECT_EQ(PriorMeanOf(model.nuisances()[1].prior), 0);
  const PlayedRecording played = Play(model, PlayedNuisances(model));
  ASSERT_TRUE(played.summary.IsUsable()) << played.summary.message;
  ASSERT_EQ(played.markers.size(), filmed_.size());
  EXPECT_EQ(played.times, item.recording.times);
  double largest = 0, moved = 0;
  for (size_t f = 0; f < filmed_.size(); ++f) {
    largest = std::max(largest, (played.markers[f] - filmed_[f]).colwise().norm().maxCoeff());
    moved = std::max(moved, (filmed_[f] - BarMarkerPlaces()).colwise().norm().maxCoeff());
  }
  // The meshes differ by a few per cent in stiffness.
  EXPECT_LT(largest, 0.1 * moved);
  EXPECT_GT(moved, 2e-3);

  const MarkerRecording exact = AsRecording(item, played, 0, 1);
  EXPECT_EQ(exact.markers.positions[9], played.markers[9]);
  const MarkerRecording noisy = AsRecording(item, played, 1e-3, 1);
  const Eigen::Matrix3Xd error = noisy.markers.positions[9] - played.markers[9];
  EXPECT_NEAR(error.norm() / std::sqrt(static_cast<double>(error.size())), 1e-3, 4e-4);
  EXPECT_EQ(AsRecording(item, played, 1e-3, 1).markers.positions[9], noisy.markers.positions[9]);
  EXPECT_NE(AsRecording(item, played, 1e-3, 2).markers.positions[9], noisy.markers.positions[9]);
}

TEST_F(PlayingARecording, NeedsTheForceThatHolds) {
  const PredictionStudy study = Study("");
  const TetMesh mesh = MakeReferenceBody(study).mesh;
  const auto body = std::make_shared<const Body>(MakeBody(mesh, study.density));
  const RecordingModel model(study, study.recordings.front(), mesh, body, {});
  EXPECT_THAT([&] { PlayedNuisances(model); },
              ThrowsMessage<InputError>(HasSubstr("bar: the object is held until 0.0437 s by a "
                                                  "force that is not known")));
}

// A bar that a jaw pulls, played with these load cells.
PlayedRecording PlayPulledBar(const TemporaryFolder& folder, const std::string& cells) {
  const PredictionStudy study =
      ReadPulledBarStudy(folder.Path(), {{"    fit_until: 11.5 s\n", cells}});
  const TetMesh mesh = PulledBarMesh();
  const auto body = std::make_shared<const Body>(MakeBody(mesh, study.density));
  const RecordingModel model(study, study.recordings.front(), mesh, body, {});
  return Play(model, PlayedNuisances(model));
}

TEST(PlayingALoadCell, ShiftsAndOffsetsItsReadings) {
  const TemporaryFolder folder;
  PulledBarTruth truth;
  truth.twist = 0.02;
  WritePulledBar(folder.Path(), truth, kLoadCell,
                 "{file: force.csv, time: t, x: mx, deviation: 0.01 N mm}");
  const PlayedRecording exact = PlayPulledBar(folder, "");
  // The frames are 1 s apart.
  const PlayedRecording wrong =
      PlayPulledBar(folder,
                    "    simulated_cells:\n      - {part: jaw, tare: [0.1 N, 0, 0], delay: 1 s}\n"
                    "      - {part: jaw, measures: torque, tare: [-2e-4 N m, 0, 0]}\n");
  ASSERT_TRUE(wrong.summary.IsUsable()) << wrong.summary.message;
  ASSERT_EQ(wrong.reactions.size(), 2u);
  const Eigen::RowVectorXd force = exact.reactions[0].values.row(0);
  const Eigen::RowVectorXd late = wrong.reactions[0].values.row(0);
  EXPECT_EQ(wrong.reactions[0].times, exact.reactions[0].times);
  ASSERT_EQ(late.size(), kPulledFrames);
  // Equilibria are known to 1e-6 of the forces, which reach 3 N.
  constexpr double kEquilibrium = 1e-5;
  EXPECT_LT((late.tail(kPulledFrames - 1).array() - 0.1 - force.head(kPulledFrames - 1).array())
                .abs()
                .maxCoeff(),
            kEquilibrium);
  EXPECT_NEAR(late[0], force[0] + 0.1, kEquilibrium);  // it is at rest before its first frame
  EXPECT_GT(force[1] - force[0], 0.1);
  // The torque is not late, and the markers have no part in either.
  const Eigen::RowVectorXd torque = exact.reactions[1].values.row(0);
  EXPECT_LT((wrong.reactions[1].values.row(0).array() + 2e-4 - torque.array()).abs().maxCoeff(),
            1e-5 * torque.cwiseAbs().maxCoeff());
  ASSERT_EQ(wrong.markers.size(), exact.markers.size());
  EXPECT_LT((wrong.markers[9] - exact.markers[9]).cwiseAbs().maxCoeff(), 1e-8);  // as above
  EXPECT_EQ(wrong.times, exact.times);
}

TEST(PlayingALoadCell, RefusesWhatTheRecordingDoesNotMeasure) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {});
  const auto refused = [&](const std::string& cell, const std::string& why) {
    EXPECT_THAT([&] { PlayPulledBar(folder, "    simulated_cells:\n      - " + cell + "\n"); },
                ThrowsMessage<InputError>(HasSubstr(why)));
  };
  refused("{part: jaw, measures: torque}", "no measured_torque of a part \"jaw\"");
  refused("{part: base}", "no measured_force of a part \"base\"");
  refused("{part: jaw, tare: [0, 0.1 N, 0]}", "direction that the load cell does not measure");
  refused("{part: jaw}\n      - {part: jaw}", "has an entry already");
  refused("{part: jaw, delay: -1 s}", "delay");
}

}  // namespace
}  // namespace lacuna
