// Planes that an object may be touching, read off its recordings: what was measured stays on one
// side of them, and the model, which knows no plane, goes through.
#ifndef LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_
#define LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"

namespace lacuna {

struct ProposedPlane {
  Eigen::Vector3d normal;  // unit, towards the side where the object is
  double offset = 0;       // m: normal·x of the plane
  double crossing = 0;     // m: how far the model's body goes beyond it
};

// Along the coordinates, gravity and the largest misfit, either way: the plane as far out as the
// object comes in the fitted recordings, where the model goes farther by more than the noise. The
// deepest crossing first. The object is where the model's body is, less the misfit of the point
// measured nearest to each node; nodes that a grip holds do not count. `misfit`: of the model at
// `values`.
std::vector<ProposedPlane> ProposePlanes(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_
