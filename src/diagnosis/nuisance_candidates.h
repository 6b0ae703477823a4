// What is no physics of the object and yet looks like it: errors of the mesh and the step, of the
// grips, of the clock, of single frames, of the registration. Each is a set of directions in which
// it would change the misfit.
#ifndef LACUNA_DIAGNOSIS_NUISANCE_CANDIDATES_H_
#define LACUNA_DIAGNOSIS_NUISANCE_CANDIDATES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"

namespace lacuna {

struct NuisanceCandidate {
  std::string name;                      // "grip_compliance"
  std::string what;                      // in words, with its place or time
  std::string advice;                    // what to do about it
  double price = 0;                      // ln of how many of its kind were tried
  Eigen::MatrixXd by = {};               // rows of a LinearisedMisfit × directions, m per unit
  std::vector<LinearPrior> priors = {};  // per direction
  // It is simulated, bounded and always there: part of every model, evidence or none.
  bool is_always_taken = false;
  bool is_of_single_frames = false;  // it changes each by itself: none tells of another
  // What it changes is known but for something of the size of `unknown` (rows × columns, as `by`)
  // that may lie in any direction; 0 columns: for nothing.
  Eigen::MatrixXd unknown = {};
};

inline constexpr char kTimeStepNuisance[] = "time_step";
// By how much a grip, a frame, a registration may be shifted, m, and turned, rad (priors).
inline constexpr double kMisplaced = 1e-3, kMisturned = 0.02;
// Of more frames than this, single ones are too small a part to be looked at one by one.
inline constexpr size_t kMostFramesEach = 400;

// What is part of every model: the difference that a finer mesh makes beyond what the parameters
// can do (mesh_limit.h), and a shorter step, none where the refined model cannot be made, their
// priors expecting the difference to the limit; and the object's three dimensions, each known to a
// part of itself, by runs of a body that is larger. `misfit`: with the parameters' derivatives.
std::vector<NuisanceCandidate> NuisancesAlwaysTaken(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values,
                                                    const LinearisedMisfit& misfit);

// Those that need no simulation: a clock that is late, frames at uncertain times, one frame out of
// place, a measuring frame that drifts. `left`: what the fit leaves of each row, in σ; it points at
// the frame that may be wrong.
std::vector<NuisanceCandidate> MeasurementNuisances(const CalibrationProblem& problem,
                                                    const LinearisedMisfit& misfit,
                                                    const Eigen::VectorXd& left);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_NUISANCE_CANDIDATES_H_
