// Studies of the held bar of which no calibration problem can be made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

std::string MessageOf(const PredictionStudy& study) {
  try {
    const CalibrationProblem problem(study, BarMesh({2, 1, 1}, 1));
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

TEST(CalibrationProblem, TellsWhatItCannotWorkWith) {
  const TemporaryFolder folder;
  // At rest, 2 mm from where the undeformed bar has the markers.
  const Eigen::Matrix3Xd moved = BarMarkerPlaces().array() + 0.002;
  WriteBarRecording(folder.Path(), std::vector<Eigen::Matrix3Xd>(kFrames, moved));
  EXPECT_THAT(
      MessageOf(ReadBarStudy(folder.Path(), {{"noise: 0.05 mm\n", ""}})),
      testing::HasSubstr("noise: cannot be estimated (no marker is seen in three frames that "
                         "follow one another, or their values contain no noise: the "
                         "markers do not move at all, or along a straight line)"));
  const std::string hold =
      "    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n"
      "      release: 0.0437 s\n";
  EXPECT_THAT(
      MessageOf(ReadBarStudy(folder.Path(),
                             {{"noise: 0.05 mm\n", ""},
                              {"motion: {time_step: 1.5 ms}", "motion: {scheme: quasi_static}"},
                              {hold, "    to: 0.005 s\n"}})),
      testing::HasSubstr("noise: cannot be estimated (fewer than three frames of markers are "));
  PredictionStudy not_fitted = ReadBarStudy(folder.Path(), {{"noise: 0.05 mm\n", ""}});
  not_fitted.recordings[0].fitted = false;  // as beside scans that are fitted
  EXPECT_THAT(MessageOf(not_fitted),
              testing::HasSubstr("noise: cannot be estimated (no recording of markers is fitted)"));
  EXPECT_THAT(
      MessageOf(ReadBarStudy(folder.Path(), {{"[0.078 m, 0 m, 0 m]", "[0.1 m, 0 m, 0 m]"}})),
      testing::HasSubstr("hold of bar"));
  EXPECT_EQ(MessageOf(ReadBarStudy(folder.Path())), "nothing was refused");
  const auto message_with_clamp = [&](const std::string& regions) {
    std::string text = FileContent(folder / "recording.yaml");
    const size_t first = text.find("fixed: [") + 8;
    text.replace(first, text.find("]\n", first) - first, regions);
    std::ofstream(folder / "recording.yaml") << text;
    return MessageOf(ReadBarStudy(folder.Path()));
  };
  const std::string clamp =
      "{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}";
  EXPECT_EQ(message_with_clamp(clamp), "nothing was refused");
  EXPECT_THAT(
      message_with_clamp(clamp +
                         ", {name: end, box: {min: [-1 m, -1 m, -1 m], max: [0.001 m, 1 m, 1 m]}}"),
      testing::HasSubstr("regions \"clamp\" and \"end\" hold the same part"));
  // Two regions: one that holds all markers is refused when the study is read.
  EXPECT_THAT(message_with_clamp(
                  "{name: left, half_space: {point: [0.041 m, 0 m, 0 m], normal: [-1, 0, 0]}}, "
                  "{name: right, half_space: {point: [0.042 m, 0 m, 0 m], normal: [1, 0, 0]}}"),
              testing::HasSubstr("\"right\" and those before it hold all"));
  WriteBarRecording(folder.Path(), std::vector<Eigen::Matrix3Xd>(kFrames, moved));
  std::string text = FileContent(folder / "recording.yaml");
  const size_t place = text.find("[", text.find("name: m2")) + 1;
  text.replace(place, text.find(" m", place) - place, "0.5");
  std::ofstream(folder / "recording.yaml") << text;
  EXPECT_THAT(MessageOf(ReadBarStudy(folder.Path())),
              testing::HasSubstr("marker_places: m2 sits 420 mm away from the object"));
}

}  // namespace
}  // namespace lacuna
