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
//
// Both meshes are simulated with time steps that are longer than the study's. The error of the step
// is nearly the same on both and cancels in the difference, while the simulations of the finer mesh
// cost a third.
struct FinerMesh {
  double ratio = 0;        // volume of the study's elements over that of the finer ones
  Eigen::VectorXd change;  // change of the parameters from the study's values (MovedBy)
  // Residuals with the longer steps, m, in the rows of the study's linearised misfit: of the
  // study's mesh, and of the finer one with the changed parameters.
  Eigen::VectorXd coarse, fine;

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

// The residual with elements whose volume is smaller by another `ratio` than those of `finer`, with
// the longer steps and the change of the parameters that belongs to that ratio. Empty where the
// shape cannot be meshed so or the mesh not be simulated. Throws Interrupted.
Eigen::VectorXd ResidualAtRatio(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                const FinerMesh& finer, double ratio);

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
