// The discretisation error of a study's mesh, estimated with a finer mesh.
#ifndef LACUNA_CALIBRATION_MESH_LIMIT_H_
#define LACUNA_CALIBRATION_MESH_LIMIT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "calibration/calibration_problem.h"

namespace lacuna {

// A finer mesh, and the parameters with which it moves like the study's own mesh.
//
// Coarse elements are too stiff, so that a vibration is fitted with a modulus that is too low. With
// the same parameters on both meshes the two motions drift apart in phase, and their difference
// cannot be scaled or added to a third motion. With parameters of its own, found by Gauss–Newton
// steps with the derivatives of the study's mesh, the finer mesh stays in phase, and the difference
// that remains is small.
struct FinerMesh {
  double ratio = 0;  // volume of the study's elements over that of the finer ones
  TetMesh mesh;
  Eigen::VectorXd change;  // change of the parameters from the study's values (MovedBy)

  // Factors by which the change is to be multiplied for the limit of infinitely fine elements, and
  // for elements of another ratio.
  double ToLimit() const;
  double ToRatio(double other) const;
};

// `misfit` is that at `values`, with its Jacobian. `fitted_only`: compare the motions in the fitted
// frames alone. Returns nothing where a finer mesh cannot be made, for example because the mesh was
// given, or cannot be simulated. Throws Interrupted.
std::optional<FinerMesh> MakeFinerMesh(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit& misfit, bool fitted_only);

// The problem with elements whose volume is smaller by this ratio; null where the shape cannot be
// meshed so finely. The study must outlive it.
std::unique_ptr<const CalibrationProblem> WithFinerElements(const PredictionStudy& study,
                                                            double ratio);

// The values to which the study, fitted to `values`, would be fitted with infinitely fine elements.
// Returns nothing where MakeFinerMesh does.
std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MESH_LIMIT_H_
