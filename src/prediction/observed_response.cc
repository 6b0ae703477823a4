#include "prediction/observed_response.h"

#include <glog/logging.h>

namespace lacuna {
namespace {

// Vectors of the nodes, stacked in the columns, in rotated coordinates.
Eigen::MatrixXd RotatedColumns(const Eigen::Matrix3d& rotation, const Eigen::MatrixXd& stacked) {
  const Eigen::Matrix3Xd rotated = rotation * stacked.reshaped(3, stacked.size() / 3);
  return rotated.reshaped(stacked.rows(), stacked.cols());
}

}  // namespace

Eigen::MatrixXd ObservedResponse(const RecordingModel& recording, const ReplayedMotion& motion,
                                 const ReducedResponse& response, const Eigen::MatrixXd& held,
                                 const ForceHistories& histories, const std::vector<int>& frames,
                                 const std::vector<Observed>& observed) {
  const PredictedRecording& item = recording.recording();
  CHECK_EQ(observed.size(), item.frames.size());
  const Eigen::Index components = recording.observer().Components();
  const Eigen::Index rows_of_frame = components * recording.PointCount();
  std::vector<double> times;
  times.reserve(frames.size());
  for (const int frame : frames)
    times.push_back(item.recording.times[item.frames[static_cast<size_t>(frame)]] - motion.delay);
  const Eigen::MatrixXd basis = RotatedColumns(motion.registration.linear(), response.basis());
  const ObservationMatrix* last = nullptr;  // the rows of markers are the same in all frames
  Eigen::MatrixXd at_points;
  Eigen::MatrixXd rows(rows_of_frame * static_cast<Eigen::Index>(frames.size()), held.cols());
  response.Respond(held, histories, times,
                   [&](int index, const Eigen::MatrixXd& position, const Eigen::MatrixXd&) {
                     const Observed& seen =
                         observed[static_cast<size_t>(frames[static_cast<size_t>(index)])];
                     if (seen.rows.get() != last) at_points = *seen.rows * basis;
                     last = seen.rows.get();
                     auto frame = rows.middleRows(rows_of_frame * index, rows_of_frame);
                     frame = at_points * position;
                     for (int point = 0; point < recording.PointCount(); ++point)
                       if (seen.count[point] == 0)
                         frame.middleRows(components * point, components).setZero();
                   });
  return rows;
}

}  // namespace lacuna
