// align(p, S): where the points of a simulated surface belong on a scanned state.
#ifndef LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_
#define LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_

#include <Eigen/Core>
#include <string>

#include "geometry/point_cloud.h"
#include "registration/coherent_point_drift.h"

namespace lacuna {

// The correspondence of Transue & Choi 2015, Eq. 1: D = align(p, S) carries each point p_i onto its
// place on the state S by non-rigid CPD.
struct Alignment {
  CpdStatus status = CpdStatus::kNotRun;
  std::string message = "not run";
  bool IsUsable() const { return status == CpdStatus::kConverged; }

  Eigen::Matrix3Xd displacement;       // 3 × n, m: D
  Eigen::VectorXd weight;              // n: points of S that each point explains; 0: none near it
  Eigen::VectorXd standard_deviation;  // n, m: of the displacement
  DisplacementField field;             // D as a field, and a start for the next alignment
};

// `points` with normals where they are known; `previous` may be the field of the last alignment of
// the same surface, to start from.
Alignment Align(const PointCloud& points, const PointCloud& state, const CpdOptions& options = {},
                const DisplacementField* previous = nullptr);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_SURFACE_ALIGNMENT_H_
