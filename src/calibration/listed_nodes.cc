#include "calibration/listed_nodes.h"

#include "scan/region.h"

namespace lacuna {

PredictionStudy WithListedNodes(const CalibrationProblem& problem) {
  PredictionStudy study = problem.WithEstimatedNoise();
  for (PredictedRecording& item : study.recordings)
    for (Region* region : RegionsIn(&item))
      region->shape = NodeRegion{SelectNodes(*region, problem.body()->mesh)};
  return study;
}

}  // namespace lacuna
