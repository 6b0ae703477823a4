// What is no physics of the object and yet looks like it: errors of the mesh and the step, of the
// grips, of the clock, of single frames, of the registration. Each is a set of directions in which
// it would change the misfit.
#ifndef LACUNA_STUDY_NUISANCE_CANDIDATES_H_
#define LACUNA_STUDY_NUISANCE_CANDIDATES_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "study/calibration_problem.h"

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
  // What it changes is known but for something of the size of `unknown` (rows × columns, as `by`)
  // that may lie in any direction; 0 columns: for nothing.
  Eigen::MatrixXd unknown = {};
};

// Directions to be simulated along the fitted motion (LinearisedMisfit::by): the placement of each
// grip (three shifts, three turns) and its compliance (it yields to its force, it turns with its
// moment). Compliance that comes out negative means a grip that reaches further than the model's.
class GripNuisances {
 public:
  explicit GripNuisances(const CalibrationProblem& problem);
  const std::vector<MisfitDirection>& directions() const { return directions_; }
  // `by`: the columns of directions(), after a run.
  std::vector<NuisanceCandidate> Candidates(const Eigen::MatrixXd& by) const;
  // What the noise of the markers that grips follow does, of quasi-static motions, where a frame's
  // errors end with it: each grip is shifted and turned by chance in every frame. None where no
  // grip follows markers, and of more frames than a few hundred.
  std::optional<NuisanceCandidate> Jitter(const CalibrationProblem& problem,
                                          const LinearisedMisfit& misfit,
                                          const Eigen::MatrixXd& by) const;

 private:
  struct Kind {
    std::string name, what, advice;
    size_t grip = 0;  // of the model
    int first = 0, count = 0;
    std::vector<std::shared_ptr<double>>
        largest;                    // motion seen, per direction; null: unit is known
    std::vector<double> deviation;  // prior, in the unit or in that motion
  };
  Eigen::MatrixXd JitterOf(const Kind& kind, const RecordedGrip& grip,
                           const Eigen::Matrix3Xd& places, double noise) const;
  std::vector<MisfitDirection> directions_;
  std::vector<Kind> kinds_;
};

// What is part of every model: the difference that a finer mesh makes, and a shorter step, none
// where the refined model cannot be made, their priors expecting the difference to the limit; and
// the object's three dimensions, each known to a part of itself, by runs of a body that is that
// much larger.
std::vector<NuisanceCandidate> NuisancesAlwaysTaken(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values,
                                                    const LinearisedMisfit& misfit);

// By how much elements as fine as can be would change the residual, to the best of what one finer
// mesh tells; with steps so many times as long. Empty where it cannot be had or simulated.
Eigen::VectorXd ChangeByMesh(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                             double steps);

// Those that need no simulation: a clock that is late, frames at uncertain times, one frame out of
// place, a measuring frame that drifts. `left`: what the fit leaves of each row, in σ; it points at
// the frame that may be wrong.
std::vector<NuisanceCandidate> MeasurementNuisances(const CalibrationProblem& problem,
                                                    const LinearisedMisfit& misfit,
                                                    const Eigen::VectorXd& left);

}  // namespace lacuna

#endif  // LACUNA_STUDY_NUISANCE_CANDIDATES_H_
