// What a study's mesh changes, against finer ones.
#ifndef LACUNA_CALIBRATION_MESH_LIMIT_H_
#define LACUNA_CALIBRATION_MESH_LIMIT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "calibration/calibration_problem.h"

namespace lacuna {

// Elements with a part of the volume, and the parameters with which they move as the study's do.
//
// Coarse elements are stiff, and what swings is then fitted with a lower modulus. With the same
// parameters on both meshes the two motions part in phase, by more the longer they last: no
// difference of two such motions can be scaled, or added to a third. With other parameters, sought
// by Gauss–Newton steps with the study's own derivatives, they stay together, and what no parameter
// can do is small.
struct FinerMesh {
  double ratio = 0;  // how many times smaller the volume is
  TetMesh mesh;
  Eigen::VectorXd change;  // of the parameters there (MovedBy)

  // Parts of what this mesh changes: to elements as fine as can be, and to others between.
  double ToLimit() const;
  double ToRatio(double other) const;
};

// `misfit`: at `values`, with the parameters' derivatives. `fitted_only`: the motion in the frames
// that were fitted. Nothing where there are no finer elements, as of a mesh that was given, or
// where they cannot be simulated. Throws Interrupted.
std::optional<FinerMesh> MakeFinerMesh(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit& misfit, bool fitted_only);

// The study with elements of so many times less volume; null where its shape cannot be meshed so.
// The study must outlive it.
std::unique_ptr<const CalibrationProblem> WithFinerElements(const PredictionStudy& study,
                                                            double ratio);

// What the study, fitted to `values`, would be fitted to with elements as fine as can be; nothing
// as above.
std::optional<Eigen::VectorXd> AtMeshLimit(const CalibrationProblem& problem,
                                           const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_MESH_LIMIT_H_
