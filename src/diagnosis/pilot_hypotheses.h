// Hypotheses that have no derivative at their null value: contact, which switches on, and another
// elasticity law in place of the model's.
//
// Each is put into the model at a plausible finite setting, the pilot setting, and the recordings
// are predicted once. With the residuals r of the model and r_pilot of that prediction, the column
// of the hypothesis is r_pilot − r (m); its amount is 0 without the effect and 1 at the pilot
// setting.
#ifndef LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_
#define LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/candidate_effect.h"
#include "record/model_errors.h"

namespace lacuna {

struct PilotHypothesis {
  CandidateEffect candidate;
  Eigen::VectorXd change;  // of the rows of the LinearisedMisfit, m
};

struct PilotHypotheses {
  std::vector<PilotHypothesis> tried;
  std::vector<UntriedEffect> untried;
};

// Tries contact with the planes that the predicted body crosses and the measured one does not
// (plane_proposals.h), also with friction on the most deeply crossed one, and each other elasticity
// law of the catalogue that can take over the moduli of the model. Types in `without` are left out.
// `misfit` belongs to the model at `values`. A pilot that cannot be simulated is reported in
// `untried`. `on_frame` is LineariseOptions::on_frame of all pilots. Throws Interrupted.
PilotHypotheses RunPilots(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          const LinearisedMisfit& misfit, const std::vector<std::string>& without,
                          const std::function<void()>& on_frame = {});

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PILOT_HYPOTHESES_H_
