#include "calibration/listed_nodes.h"

#include "scan/region.h"

namespace lacuna {

PredictionStudy WithListedNodes(const CalibrationProblem& problem) {
  PredictionStudy study = problem.WithEstimatedNoise();
  for (PredictedRecording& item : study.recordings) {
    std::vector<Region*> regions = RegionsIn(&item.recording.object);
    if (item.hold) regions.push_back(&item.hold->region);
    for (Region* region : regions)
      region->shape = NodeRegion{SelectNodes(*region, problem.body()->mesh)};
  }
  return study;
}

}  // namespace lacuna
