// align(p, S): the correspondence from the points of a simulated surface to a scanned state.
#ifndef LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_
#define LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_

#include <Eigen/Core>
#include <string>

#include "geometry/point_cloud.h"
#include "registration/coherent_point_drift.h"

namespace lacuna {

// The correspondence of Transue & Choi 2015, Eq. 1: D = align(p, S) moves each point p_i to its
// corresponding position on the state S, computed by non-rigid CPD (coherent_point_drift.h).
struct Alignment {
  CpdStatus status = CpdStatus::kNotRun;
  std::string message = "not run";
  bool IsUsable() const { return status == CpdStatus::kConverged; }

  Eigen::Matrix3Xd displacement;       // 3 × n, m: D
  Eigen::VectorXd weight;              // n: number of points of S assigned to each; 0: none nearby
  Eigen::VectorXd standard_deviation;  // n, m: posterior standard deviation of D
  DisplacementField field;             // D as a field, which can start the next alignment
};

// Aligns `points`, with normals if they are known, with the scanned `state`. `previous` may be the
// field of an earlier alignment of the same surface, used as the starting point. On failure the
// status says why, and the vectors may be empty.
Alignment Align(const PointCloud& points, const PointCloud& state, const CpdOptions& options = {},
                const DisplacementField* previous = nullptr);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_
