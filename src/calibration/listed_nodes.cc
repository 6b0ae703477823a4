#include "calibration/listed_nodes.h"

#include "scan/region.h"

namespace lacuna {

PredictionStudy WithListedNodes(const CalibrationProblem& problem) {
  const Eigen::Matrix3Xd& nodes = problem.body()->mesh.nodes;
  const auto list = [&](Region* region) {
    region->shape = NodeRegion{SelectNodes(*region, nodes), {}};
  };
  PredictionStudy study = problem.WithEstimatedNoise();
  for (PredictedRecording& item : study.recordings) {
    RecordedObject& object = item.recording.object;
    for (RecordedSupport& support : object.fixed) list(&support.region);
    for (RecordedGrip& grip : object.grips) list(&grip.region);
    for (MeasuredForce& force : object.forces)
      if (force.region) list(&*force.region);
    if (item.hold) list(&item.hold->region);
  }
  return study;
}

}  // namespace lacuna
