// Proposes planes with which the object may be in contact: the measured body stays on one side of
// them, and the predicted body, whose model has no plane, crosses them.
//
// For a direction d, the predicted body reaches max d·x over its nodes x and frames, and the object
// max d·(x − u), where u (predicted − measured) is the residual of the measured point nearest to
// the node. A plane with normal −d through the object's reach is proposed where the predicted body
// reaches further, by more than √(2 ln N) σ, about the largest of N errors of noise.
#ifndef LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_
#define LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"

namespace lacuna {

struct ProposedPlane {
  Eigen::Vector3d normal;  // unit, points to the side of the object
  double offset = 0;       // m, normal·x of points x on the plane
  double crossing = 0;     // m, how far the predicted body goes beyond it
};

// Looks along both directions of the coordinate axes and of gravity, and along the largest
// residual, in the fitted recordings; nodes held by a grip do not count. The most deeply crossed
// plane comes first; none if none is crossed. `misfit` belongs to the model at `values`.
std::vector<ProposedPlane> ProposePlanes(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PLANE_PROPOSALS_H_
