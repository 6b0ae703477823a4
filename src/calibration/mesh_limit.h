// The discretisation error of a study's mesh, estimated with another mesh.
#ifndef LACUNA_CALIBRATION_MESH_LIMIT_H_
#define LACUNA_CALIBRATION_MESH_LIMIT_H_

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "calibration/calibration_problem.h"

namespace lacuna {

// Another mesh, and the parameters with which it moves like the study's own mesh. It is finer; of a
// study with thousands of elements it is coarser, because a finer one would cost many times what
// the study itself does.
//
// Coarse elements are too stiff, so that a vibration is fitted with a modulus that is too low. With
// the same parameters on both meshes the two motions drift apart in phase, and their difference
// cannot be scaled or added to a third motion. With parameters of its own, found by Gauss–Newton
// steps with the derivatives of the study's mesh, the other mesh stays in phase, and the difference
// that remains is small.
//
// Both meshes are simulated with time steps that are longer than the study's. The error of the step
// is nearly the same on both and cancels in the difference, while the simulations of a finer mesh
// cost a third.
struct OtherMesh {
  double ratio = 0;        // mean volume of the study's elements over that of the other ones
  Eigen::VectorXd change;  // change of the parameters from the study's values (MovedBy)
  // Residuals with the longer steps, m, in the rows of the study's linearised misfit: of the
  // study's mesh, and of the other one with the changed parameters.
  Eigen::VectorXd own, other;

  bool IsFiner() const { return ratio > 1; }
  // Factors by which the change is to be multiplied for the limit of infinitely fine elements
  // (negative if the other mesh is coarser), and for elements of another ratio.
  double ToLimit() const;
  // The standard deviation of ToLimit(): the correction beyond the finest of the meshes is
  // uncertain by itself, and by no less than 0.4 of the change. Calibrated on bars of 160 to 190
  // quadratic elements; larger: wider intervals, and more evidence is asked of an effect.
  double DeviationOfLimit() const;
  double ToRatio(double other_ratio) const;
};

// `misfit` is that at `values`, with its Jacobian. The motions are compared in all frames of the
// fitted recordings. `known`: what was found at these values or near them; where the study's mesh
// moves as it did then, the other one is not simulated again at that change. Null: nothing is
// known. `on_frame` is LineariseOptions::on_frame of the predictions. Returns nothing where another
// mesh cannot be made (calibration/other_elements.h) or cannot be simulated. Throws Interrupted.
std::optional<OtherMesh> MakeOtherMesh(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit& misfit,
                                       const OtherMesh* known = nullptr,
                                       const std::function<void()>& on_frame = {});

// Writes other_mesh.json and other_mesh.npy into a folder, and reads them; nothing where the folder
// has no such files. Both throw InputError naming the file.
void WriteOtherMesh(const OtherMesh& mesh, const std::filesystem::path& folder);
std::optional<OtherMesh> ReadOtherMesh(const std::filesystem::path& folder);

// The residual with elements whose volume is smaller by `ratio`, with the longer steps and the
// change of the parameters that belongs to that ratio. Empty where the shape cannot be meshed so or
// the mesh not be simulated. Throws Interrupted.
Eigen::VectorXd ResidualAtRatio(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                const OtherMesh& known, double ratio);

// The study's problem on another mesh (calibration/other_elements.h); nothing where that mesh
// cannot be made or a region holds none of its nodes. `own`: the study's mesh. The study must
// outlive the problem.
struct ProblemOnOtherMesh {
  std::unique_ptr<const CalibrationProblem> problem;
  double ratio = 1;  // as in OtherMesh
};
std::optional<ProblemOnOtherMesh> WithOtherElements(const PredictionStudy& study,
                                                    const TetMesh& own, double ratio);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MESH_LIMIT_H_
