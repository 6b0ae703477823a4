// Hypotheses that have no derivative where they vanish: contact, which switches on, and another
// elasticity law in place of the model's. Each is put into the model at a plausible finite setting,
// its pilot, and the recordings are predicted once; the difference that it makes is the hypothesis'
// column, with an amount that is 1 at the pilot.
#ifndef LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_
#define LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/candidates.h"
#include "record/model_errors.h"

namespace lacuna {

struct PilotHypothesis {
  CandidateEffect candidate;
  Eigen::VectorXd by;  // rows of the LinearisedMisfit: pilot run − present run, m
};

struct PilotHypotheses {
  std::vector<PilotHypothesis> tried;
  std::vector<UntriedEffect> untried;
};

// Contact with the planes that the model crosses and the object does not (plane_proposals.h), the
// deepest crossed also with friction; each elasticity law of the catalogue that the model does not
// have, with its moduli. All but the types in `without`. `misfit`: of the model at `values`, at
// which it is left.
PilotHypotheses RunPilots(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          const LinearisedMisfit& misfit, const std::vector<std::string>& without);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_
