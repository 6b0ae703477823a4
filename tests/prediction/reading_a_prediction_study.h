// A fixture for tests that read the study of a recorded bar after something in it was replaced.
#ifndef LACUNA_TESTS_PREDICTION_READING_A_PREDICTION_STUDY_H_
#define LACUNA_TESTS_PREDICTION_READING_A_PREDICTION_STUDY_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/error.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/temporary_folder.h"

namespace lacuna {

using Replacements = std::map<std::string, std::string>;

// Markers that rest and then all go one way, by `speed` m per frame.
inline std::vector<Eigen::Matrix3Xd> Moving(double speed, int rests = 5) {
  std::vector<Eigen::Matrix3Xd> markers;
  for (int frame = 0; frame < kFrames; ++frame)
    markers.emplace_back(BarMarkerPlaces().array() + speed * std::max(0, frame - rests));
  return markers;
}

class ReadingAPredictionStudy : public testing::Test {
 protected:
  ReadingAPredictionStudy() { WriteBarRecording(folder_.Path(), Moving(0.001)); }

  std::string MessageAfter(const Replacements& replaced) const {
    return MessageOf(BarExperiment(folder_.Path(), replaced));
  }
  std::string MessageOf(const std::string& experiment) const {
    try {
      ReadPredictionStudy(Config::Parse(experiment, (folder_ / "study.yaml").string()));
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "nothing was refused";
  }
  std::string MessageAfterInRecording(const Replacements& replaced,
                                      const Replacements& in_study = {}) const {
    WriteBarRecording(folder_.Path(), Moving(0.001));
    ReplaceInFile(folder_ / "recording.yaml", replaced);
    return MessageAfter(in_study);
  }

  TemporaryFolder folder_;
};

// Removes the hold, so that the recording has to start at rest.
inline const Replacements kNoHold{
    {"    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n",
     ""},
    {"      release: 0.0437 s\n", ""}};

}  // namespace lacuna

#endif  // LACUNA_TESTS_PREDICTION_READING_A_PREDICTION_STUDY_H_
