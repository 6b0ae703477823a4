// The parameters of a study whose elements are as fine as can be.
#ifndef LACUNA_STUDY_MESH_LIMIT_H_
#define LACUNA_STUDY_MESH_LIMIT_H_

#include <Eigen/Core>
#include <optional>

#include "study/calibration_problem.h"

namespace lacuna {

// What the study would be fitted to with elements as fine as can be, sought from `values`: to its
// fitted frames, or to the held-out ones, too, as evidence counts them (what finer elements and
// effects change is best known there, nuisance_candidates.h). Nothing where there are no finer
// elements, as of a mesh that was given, where they cannot be simulated, or where no step comes
// nearer to it. Throws Interrupted.
std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values, bool fitted_only);

}  // namespace lacuna

#endif  // LACUNA_STUDY_MESH_LIMIT_H_
