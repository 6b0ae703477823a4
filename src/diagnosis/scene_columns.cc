#include "diagnosis/scene_columns.h"

#include <glog/logging.h>

namespace lacuna {

SceneColumns SceneColumns::ForOtherStep() const {
  SceneColumns others{nuisances, std::nullopt};
  std::erase_if(others.nuisances, [](const NuisanceCandidate& nuisance) {
    return nuisance.card.shrinks_with_time_step;
  });
  return others;
}

SceneColumns SceneColumns::ForFirstFrames(const std::vector<LinearisedMisfit::Part>& whole,
                                          const std::vector<PredictedRecording>& beginnings) const {
  std::vector<Eigen::Index> rows;
  size_t recordings = 0;
  for (const LinearisedMisfit::Part& part : whole) {
    if (part.IsOfPoints()) ++recordings;
    CHECK_LE(recordings, beginnings.size());
    const size_t frames = beginnings[recordings - 1].frames.size();
    CHECK_LE(frames, part.layout.times.size());
    const Eigen::Index count = static_cast<Eigen::Index>(frames) * part.layout.series;
    for (Eigen::Index row = 0; row < count; ++row) rows.push_back(part.first_row + row);
  }
  CHECK_EQ(recordings, beginnings.size());
  SceneColumns first{nuisances, std::nullopt};
  for (NuisanceCandidate& nuisance : first.nuisances) {
    nuisance.columns = Eigen::MatrixXd(nuisance.columns(rows, Eigen::all));
    if (nuisance.unknown.cols() > 0)
      nuisance.unknown = Eigen::MatrixXd(nuisance.unknown(rows, Eigen::all));
  }
  return first;
}

}  // namespace lacuna
