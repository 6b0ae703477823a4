// The recording of a held bar, played with the model that made it but for its mesh and its step.
#include "prediction/played_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
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

}  // namespace
}  // namespace lacuna
