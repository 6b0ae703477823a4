// How far a fitted model is from each of its recordings, fitted or not.
#ifndef LACUNA_CALIBRATION_RECORDING_MISFIT_H_
#define LACUNA_CALIBRATION_RECORDING_MISFIT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "record/model_errors.h"

namespace lacuna {

// The misfit of one recording, all frames.
struct RecordingMisfit {
  std::string name;
  Misfit misfit;
  Eigen::VectorXd nuisance;        // in the order of RecordingModel::nuisances
  std::vector<char> fitted;        // per frame of the misfit
  Eigen::MatrixXd place_offset;    // components × points, m: the errors of the points' places
  bool has_own_places = true;      // false: they are those that fitted recordings tell
  MisfitMeasure in_fit, held_out;  // held out in time, or the whole recording
};

// Of every recording at these values of the problem's parameters; of one that is not fitted, as
// CalibrationProblem::NuisanceOf and PlacesToldBy have it.
std::vector<RecordingMisfit> MisfitsOf(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_RECORDING_MISFIT_H_
