// How far a simulated surface is from what was scanned (Transue & Choi 2015, section 6).
#ifndef LACUNA_ANALYSIS_MEASURE_H_
#define LACUNA_ANALYSIS_MEASURE_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Lengths, one per point, and what is usually said of them; all m.
struct LengthSummary {
  Eigen::VectorXd lengths;
  double sum = 0;   // |D| of Eq. 1, where the lengths are those of the alignment align(p, S) − p
  double mean = 0;  // the same per point: does not grow with the number of points
  double rms = 0;
  double max = 0;
};
// Summary of non-negative lengths; those that are NaN (not measured) are left out. All 0 when
// nothing is left.
LengthSummary Summarise(const Eigen::VectorXd& lengths);

// |D_anim| of Eq. 2: Σ |D| over the frames, m.
double AnimationResidual(const std::vector<LengthSummary>& frames);

// Distances of scanned points from the surface; needs no correspondence and no registration.
LengthSummary DistanceToSurface(const TriMesh& surface, const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_MEASURE_H_
