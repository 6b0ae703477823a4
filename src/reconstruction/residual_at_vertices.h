// The residual displacement D at the vertices of the model's surface, for files and pictures.
#ifndef LACUNA_RECONSTRUCTION_RESIDUAL_AT_VERTICES_H_
#define LACUNA_RECONSTRUCTION_RESIDUAL_AT_VERTICES_H_

#include <Eigen/Core>
#include <vector>

#include "experiment/frame_states.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {

// FollowedFrame::residual belongs to the vertices, or to tracked points that identify themselves. A
// vertex then gets the residual of the tracked point that is nearest to it in the undeformed body.
class ResidualAtVertices {
 public:
  ResidualAtVertices(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                     const FollowedMotion& motion);

  // 3 × boundary vertices, m; NaN where it was not measured.
  Eigen::Matrix3Xd Of(const FollowedFrame& frame) const;

 private:
  bool are_identified_;
  Eigen::Index vertices_;
  std::vector<Eigen::Index> nearest_;  // the tracked point of each vertex; empty: there is none
};

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RESIDUAL_AT_VERTICES_H_
