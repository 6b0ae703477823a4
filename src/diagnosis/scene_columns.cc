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
  CHECK_EQ(whole.size(), beginnings.size());
  std::vector<Eigen::Index> rows;
  for (size_t k = 0; k < whole.size(); ++k) {
    CHECK_LE(beginnings[k].frames.size(), whole[k].layout.times.size());
    const Eigen::Index count =
        static_cast<Eigen::Index>(beginnings[k].frames.size()) * whole[k].layout.series;
    for (Eigen::Index row = 0; row < count; ++row) rows.push_back(whole[k].first_row + row);
  }
  SceneColumns first{nuisances, std::nullopt};
  for (NuisanceCandidate& nuisance : first.nuisances) {
    nuisance.columns = Eigen::MatrixXd(nuisance.columns(rows, Eigen::all));
    if (nuisance.unknown.cols() > 0)
      nuisance.unknown = Eigen::MatrixXd(nuisance.unknown(rows, Eigen::all));
  }
  return first;
}

}  // namespace lacuna
