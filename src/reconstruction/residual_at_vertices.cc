#include "reconstruction/residual_at_vertices.h"

#include <limits>

#include "geometry/finite_columns.h"
#include "geometry/nearest.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {

ResidualAtVertices::ResidualAtVertices(const ReconstructionStudy& study,
                                       const std::vector<FrameState>& states,
                                       const FollowedMotion& motion)
    : are_identified_(HasIdentifiedPoints(study, states)),
      vertices_(motion.body->boundary.node.size()) {
  if (!are_identified_) return;
  const Eigen::Matrix3Xd places = FindPlacesAtRest(study, states).tracked;
  const std::vector<Eigen::Index> known = FiniteColumns(places);
  if (known.empty()) return;
  const PointHits near =
      PointSearch(places(Eigen::all, known)).Nearest(motion.body->boundary.surface.vertices);
  for (const int point : near.index.row(0)) nearest_.push_back(known[static_cast<size_t>(point)]);
}

Eigen::Matrix3Xd ResidualAtVertices::Of(const FollowedFrame& frame) const {
  if (!are_identified_) return frame.residual;
  if (nearest_.empty())
    return Eigen::Matrix3Xd::Constant(3, vertices_, std::numeric_limits<double>::quiet_NaN());
  return frame.residual(Eigen::all, nearest_);
}

}  // namespace lacuna
