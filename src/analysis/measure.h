// Error measures between a simulated surface and scanned points (Transue & Choi 2015, section 6).
//
// All lengths are in m.
#ifndef LACUNA_ANALYSIS_MEASURE_H_
#define LACUNA_ANALYSIS_MEASURE_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Lengths, one per point, and their statistics.
struct LengthSummary {
  Eigen::VectorXd lengths;
  double sum = 0;   // |D| of Eq. 1 if the lengths are those of the alignment, align(p, S) − p
  double mean = 0;  // sum per point, independent of the number of points
  double rms = 0;
  double max = 0;
};
// Summarises non-negative lengths. NaN stands for a length that was not measured and is left out.
// All statistics are 0 if no length remains.
LengthSummary Summarise(const Eigen::VectorXd& lengths);

// |D_anim| of Eq. 2, the sum of |D| over the frames.
double AnimationResidual(const std::vector<LengthSummary>& frames);

// The distances of scanned points (3 × m) from the nearest points of the surface. They need neither
// correspondences nor a registration.
LengthSummary DistanceToSurface(const TriMesh& surface, const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_MEASURE_H_
