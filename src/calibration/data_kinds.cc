#include "calibration/data_kinds.h"

#include <glog/logging.h>

namespace lacuna {
namespace {

DataKind KindOfPoints(const RecordingModel& model) {
  return model.recording().ShowsScans() ? &ByDataKind::scans : &ByDataKind::markers;
}

}  // namespace

bool HasSeveralKinds(const CalibrationProblem& problem) {
  ByDataKind recordings;  // with data of each kind
  for (const RecordingModel& model : problem.models()) {
    if (!model.recording().fitted) continue;
    recordings.*KindOfPoints(model) += 1;
    if (!model.Reactions().empty()) recordings.forces += 1;
  }
  int kinds = 0;
  for (const auto& [name, kind] : kDataKinds) kinds += recordings.*kind > 0;
  return kinds > 1;
}

std::vector<DataKind> KindsOfParts(const LinearisedMisfit& misfit,
                                   const CalibrationProblem& problem) {
  std::vector<DataKind> kinds;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    kinds.push_back(part.IsOfPoints() ? KindOfPoints(problem.models()[part.recording])
                                      : &ByDataKind::forces);
  return kinds;
}

ByDataKind SumsByKind(const Eigen::VectorXd& values, const LinearisedMisfit& misfit,
                      const std::vector<DataKind>& kinds) {
  CHECK_EQ(kinds.size(), misfit.parts.size());
  ByDataKind sums;
  for (size_t k = 0; k < kinds.size(); ++k) {
    const LinearisedMisfit::Part& part = misfit.parts[k];
    CHECK_LE(part.first_row + part.layout.Rows(), values.size());
    sums.*kinds[k] += values.segment(part.first_row, part.layout.Rows()).sum();
  }
  return sums;
}

}  // namespace lacuna
