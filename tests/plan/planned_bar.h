// The study of a bar whose recording shows it moving aside: what protocols are applied to.
#ifndef LACUNA_TESTS_PLAN_PLANNED_BAR_H_
#define LACUNA_TESTS_PLAN_PLANNED_BAR_H_

#include <map>
#include <string>
#include <vector>

#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {

struct PlannedBar {
  explicit PlannedBar(const std::map<std::string, std::string>& replaced = {}) {
    std::vector<Eigen::Matrix3Xd> markers(kFrames, BarMarkerPlaces());
    for (int k = 0; k < kFrames; ++k) markers[static_cast<size_t>(k)].row(1).array() += 1e-3 * k;
    WriteBarRecording(folder.Path(), markers);
    study = ReadBarStudy(folder.Path(), replaced);
  }
  const std::string& Name() const { return study.recordings.front().name; }

  TemporaryFolder folder;
  TetMesh mesh = BarMesh({4, 1, 1}, 2);
  PredictionStudy study;
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_PLAN_PLANNED_BAR_H_
