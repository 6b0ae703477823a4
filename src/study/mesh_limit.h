// The parameters of a study whose elements are as fine as can be.
#ifndef LACUNA_STUDY_MESH_LIMIT_H_
#define LACUNA_STUDY_MESH_LIMIT_H_

#include <Eigen/Core>

#include "study/calibration_problem.h"

namespace lacuna {

// What the study would be fitted to with elements as fine as can be, and with the held-out frames,
// which evidence counts too: what finer elements and effects change is best known there
// (nuisance_candidates.h). `values` where those cannot be simulated. Throws Interrupted.
Eigen::VectorXd AtMeshLimit(const CalibrationProblem& problem, const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_STUDY_MESH_LIMIT_H_
