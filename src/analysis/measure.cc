#include "analysis/measure.h"

#include <cmath>

#include "geometry/nearest.h"

namespace lacuna {

LengthSummary Summarise(const Eigen::VectorXd& lengths) {
  LengthSummary summary;
  summary.lengths = lengths;
  double squared_sum = 0;
  Eigen::Index count = 0;
  for (const double length : lengths) {
    if (std::isnan(length)) continue;
    summary.sum += length;
    squared_sum += length * length;
    summary.max = std::max(summary.max, length);
    ++count;
  }
  if (count > 0) {
    summary.mean = summary.sum / static_cast<double>(count);
    summary.rms = std::sqrt(squared_sum / static_cast<double>(count));
  }
  return summary;
}

double AnimationResidual(const std::vector<LengthSummary>& frames) {
  double sum = 0;
  for (const LengthSummary& frame : frames) sum += frame.sum;
  return sum;
}

LengthSummary DistanceToSurface(const TriMesh& surface, const Eigen::Matrix3Xd& points) {
  return Summarise(SurfaceSearch(surface).Nearest(points).distance);
}

}  // namespace lacuna
