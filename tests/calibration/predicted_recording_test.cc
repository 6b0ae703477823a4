// Recordings and frames that are only predicted: a fit does not use them, but they use what it has
// found.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "calibration/held_bar_fit.h"
#include "calibration/held_out_misfit.h"
#include "record/csv_table.h"
#include "scan/mesh_frames.h"
#include "support/replace_in_file.h"
#include "support/silent_fit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Neither the frames after `fit_until` nor a recording that is only predicted, not even through the
// estimate of the noise.
TEST(CalibrationProblem, DoesNotUseWhatIsHeldOut) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Matrix3Xd> filmed = FilmHeldBar({});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.005, 0.005);
  const auto shifted_from = [&](size_t first) {
    std::vector<Eigen::Matrix3Xd> altered = filmed;
    for (size_t frame = first; frame < altered.size(); ++frame)
      for (double& coordinate : altered[frame].reshaped()) coordinate += shift(random);
    return altered;
  };
  const auto fit = [&](const std::string& name, const std::vector<Eigen::Matrix3Xd>& first,
                       const std::vector<Eigen::Matrix3Xd>& second) {
    WriteBarRecording(folder / name, first);
    WriteBarRecording(folder / name / "other", second);
    std::map<std::string, std::string> changes = WithOtherRecording("    fitted: false\n");
    changes["noise: 0.05 mm\n"] = "";
    const PredictionStudy study = ReadBarStudy(folder / name, changes);
    const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
    const Calibration calibration = FitSilently(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return calibration;
  };
  const Calibration plain = fit("plain", filmed, filmed);
  const Calibration altered = fit("altered", shifted_from(16), shifted_from(8));
  EXPECT_EQ(altered.parameters, plain.parameters);
  EXPECT_EQ(altered.covariance, plain.covariance);
  const Calibration other = fit("other", shifted_from(15), filmed);
  EXPECT_NE(other.parameters, plain.parameters);
}

// As if marker m7 were 1.5 mm nearer to the clamp than it is.
void Misplace(const std::filesystem::path& file) {
  ReplaceInFile(file, "m7, position: [0.08 m", "m7, position: [0.0785 m");
}

// Lists the markers of a recording in the opposite order, under their names.
void ReverseMarkers(const std::filesystem::path& folder) {
  const CsvTable table = ReadCsv(folder / "markers.csv");
  CsvTable reversed{table[0]};
  for (size_t m = table.size() / 3; m > 0; --m)
    reversed.insert(reversed.end(), {table[3 * m - 2], table[3 * m - 1], table[3 * m]});
  WriteCsv(reversed, folder / "markers.csv");
}

TEST(CalibrationProblem, NumbersThePlacesOfMarkers) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  WriteBarRecording(folder / "other", FilmHeldBar({}));
  ReverseMarkers(folder / "other");
  PredictionStudy study = ReadBarStudy(folder.Path(), WithOtherRecording(""));
  const TetMesh mesh = BarMesh({3, 1, 1}, 2);
  const auto ids = [&](size_t recording) {
    return CalibrationProblem(study, mesh).PlaceIds(recording);
  };
  EXPECT_THAT(ids(0), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(ids(1), testing::ElementsAre(7, 6, 5, 4, 3, 2, 1, 0));
  // A marker at another place, and one with another name.
  study.recordings[1].recording.markers.places(0, 0) += 1e-3;
  study.recordings[1].recording.markers.names[2] = "new";
  EXPECT_THAT(ids(1), testing::ElementsAre(8, 6, 9, 4, 3, 2, 1, 0));
  EXPECT_TRUE(CalibrationProblem(study, mesh).ShareMarkers(0, 1));
  // Places that are read off the first frame are known better than those that were measured.
  MeshFrames tracked;
  tracked.tracked = true;
  study.recordings[1].recording.frames = tracked;
  study.place_deviation_is_given = false;
  EXPECT_THAT(ids(1), testing::ElementsAre(8, 9, 10, 11, 12, 13, 14, 15));
  EXPECT_FALSE(CalibrationProblem(study, mesh).ShareMarkers(0, 1));
}

// The errors of the markers' places are common to recordings: two with the same residuals r tell
// as much as one whose noise is smaller by √2, since
//   [r; r]ᵀ (σ² 1 + s² u uᵀ)⁻¹ [r; r] = rᵀ (σ²/2 1 + s² v vᵀ)⁻¹ r,   u = [v; v].
TEST(CalibrationProblem, SharesThePlacesOfMarkersBetweenRecordings) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  WriteBarRecording(folder / "other", FilmHeldBar({}));
  ReverseMarkers(folder / "other");
  const auto squares = [&](const std::string& place, const std::string& noise, bool is_twofold) {
    std::map<std::string, std::string> changes;
    if (is_twofold) changes = WithOtherRecording(fmt::format("    fit_until: {} s\n", kFitUntil));
    changes["place_deviation: 0.2 mm"] = "place_deviation: " + place;
    changes["noise: 0.05 mm"] = "noise: " + noise;
    const PredictionStudy study = ReadBarStudy(folder.Path(), changes);
    const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
    const ResidualEvaluation prediction = problem.Predict(problem.Start(), false);
    EXPECT_TRUE(prediction.usable) << prediction.message;
    return prediction.residual.squaredNorm();
  };
  const double together = squares("1 mm", "0.1 mm", true);
  EXPECT_NEAR(together, squares("1 mm", "0.070710678118654752 mm", false), 1e-9 * together);
  // Places that are known leave all of the residuals, and wide priors take most of the rest.
  EXPECT_GT(squares("0 mm", "0.1 mm", true), 1.01 * together);
}

// Where a marker is on the object, a fitted recording tells for one that is not fitted.
TEST(CalibrationProblem, KnowsMisplacedMarkersFromFittedRecordings) {
  const TemporaryFolder folder;
  HeldBarTruth other_hold;
  other_hold.hold_force = {0, -0.03, 0.04};
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  WriteBarRecording(folder / "other", FilmHeldBar(other_hold));
  ReverseMarkers(folder / "other");
  const auto misfits = [&] {
    std::map<std::string, std::string> changes =
        WithOtherRecording("    fitted: false\n    clock_deviation: 10 ms\n");
    changes["place_deviation: 0.2 mm"] = "place_deviation: 1 mm";
    const PredictionStudy study = ReadBarStudy(folder.Path(), changes);
    const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
    const Calibration calibration = FitSilently(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return MisfitsOf(problem, calibration.parameters);
  };
  Misplace(folder / "other" / "recording.yaml");
  const std::vector<RecordingMisfit> apart = misfits();
  EXPECT_TRUE(apart[0].has_own_places);
  Misplace(folder / "recording.yaml");
  const std::vector<RecordingMisfit> together = misfits();
  EXPECT_FALSE(together[0].has_own_places);
  // Each from a prediction whose equilibrium was sought near another one.
  EXPECT_LT((together[0].place_offset.rowwise().reverse() - together[1].place_offset)
                .lpNorm<Eigen::Infinity>(),
            1e-9);
  EXPECT_NEAR(std::abs(together[1].place_offset(0, 7)), 1.5e-3, 2e-4);
  // The meshes differ.
  EXPECT_LT(together[0].held_out.rms, 3e-4);
  // At the measured places, one of the markers is 1.5 mm off in every frame.
  const MisfitMeasure& measure = together[0].held_out;
  const double markers = measure.points / static_cast<double>(measure.frames);
  EXPECT_NEAR(std::pow(measure.rms_at_measured_places, 2) - std::pow(measure.rms, 2),
              std::pow(1.5e-3, 2) / markers, 0.3 * std::pow(1.5e-3, 2) / markers);
}

// Of a recording that is not fitted, the coordinate system may have been set up anew.
TEST(CalibrationProblem, KnowsTheRegistrationOfARecording) {
  const TemporaryFolder folder;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, -2, 2) / 3).toRotationMatrix();
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  WriteBarRecording(folder.Path(), markers);
  for (Eigen::Matrix3Xd& frame : markers)
    frame = (turn * frame).colwise() + Eigen::Vector3d(0.5e-3, 1e-3, -0.7e-3);
  WriteBarRecording(folder / "other", markers);
  const auto misfits = [&](const std::string& registration) {
    const PredictionStudy study = ReadBarStudy(
        folder.Path(),
        WithOtherRecording("    fitted: false\n    clock_deviation: 10 ms\n" + registration));
    const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
    const Calibration calibration = FitSilently(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return MisfitsOf(problem, calibration.parameters);
  };
  EXPECT_GT(misfits("")[0].held_out.rms, 1e-3);
  const std::vector<RecordingMisfit> registered =
      misfits("    registration: {shift_deviation: 1 mm, turn_deviation: 1 deg}\n");
  // As well as the same motion is predicted in the coordinate system of the model.
  EXPECT_LT(registered[0].held_out.rms,
            1.2 * std::max(registered[1].in_fit.rms, registered[1].held_out.rms));
}

}  // namespace
}  // namespace lacuna
