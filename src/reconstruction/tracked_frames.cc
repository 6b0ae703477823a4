#include "reconstruction/tracked_frames.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include "core/interrupt.h"
#include "fit/observations.h"
#include "registration/surface_alignment.h"

namespace lacuna {

Eigen::Matrix3Xd TrackedFrames::DisplacementAt(size_t k, const Eigen::Matrix3Xd& at_rest) const {
  while (k > 0 && fields[k].IsEmpty()) --k;
  if (k == 0) return Eigen::Matrix3Xd::Zero(3, at_rest.cols());
  return fields[k].Evaluate(at_rest);
}

Eigen::VectorXd TrackedFrames::DeviationAt(size_t k, const Eigen::Matrix3Xd& at_rest) const {
  if (fields[k].IsEmpty())
    return Eigen::VectorXd::Constant(at_rest.cols(), k == 0 ? 0 : kUnobserved);
  return fields[k].StandardDeviation(at_rest);
}

TrackedFrames TrackFrames(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                          Progress* progress) {
  TrackedFrames tracked;
  const PointCloud first = StatePoints(states.front());
  tracked.points = first.points;
  tracked.fields.resize(states.size());
  tracked.failures.resize(states.size());
  DisplacementField last;
  progress->Begin("tracking", static_cast<int64_t>(states.size()));
  for (size_t k = 1; k < states.size(); ++k) {
    ThrowIfInterrupted();
    const Alignment aligned =
        Align(first, StatePoints(states[k]), study.registration, last.IsEmpty() ? nullptr : &last);
    if (!aligned.IsUsable()) {
      tracked.warnings.push_back(
          fmt::format("frame {}: registration: {}", study.frames[k], aligned.message));
      LOG(WARNING) << tracked.warnings.back();
    }
    tracked.fields[k] = aligned.field;
    if (aligned.field.IsEmpty())
      tracked.failures[k] = aligned.message;
    else
      last = aligned.field;
    progress->Report(static_cast<int64_t>(k + 1));
  }
  progress->End();
  return tracked;
}

}  // namespace lacuna
