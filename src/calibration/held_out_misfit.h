// The misfit of a fitted model in each of its recordings: in the frames that were fitted, and in
// those that were held out.
#ifndef LACUNA_CALIBRATION_HELD_OUT_MISFIT_H_
#define LACUNA_CALIBRATION_HELD_OUT_MISFIT_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "record/fitted_reaction.h"
#include "record/model_errors.h"

namespace lacuna {

// The misfit of one recording over all of its frames.
struct RecordingMisfit {
  std::string name;
  Misfit misfit;
  Eigen::VectorXd nuisance;        // in the order of RecordingModel::nuisances
  std::vector<char> fitted;        // for each frame of the misfit
  Eigen::MatrixXd place_offset;    // components × points, m: the errors of the points' places
  bool has_own_places = true;      // false: other recordings, listed before or fitted, tell them
  MisfitMeasure in_fit, held_out;  // held out: later frames, or the whole recording
  std::vector<FittedReaction> reactions;  // one per reading of RecordingModel::Reactions()
};

// For each of these frames of a recording, whether it tells where the recording's points lie on the
// object. A recording that is not fitted does so only in the frames before its motion.
std::vector<char> TellsPlaces(const PredictedRecording& item, const std::vector<int>& frames);

// The misfits of all recordings at these values of the problem's parameters. Where the markers are
// on the object, all fitted recordings of these markers tell together, also for a recording that is
// not fitted, whose nuisances are those of CalibrationProblem::NuisanceOf.
// `known`, if given: the misfit of the problem at `values`, from which the predictions of fitted
// recordings with markers are taken. `on_frame`, unless it is empty, is called by several threads
// at once whenever a frame of a misfit has been predicted.
std::vector<RecordingMisfit> MisfitsOf(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       const LinearisedMisfit* known = nullptr,
                                       const std::function<void()>& on_frame = {});

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_HELD_OUT_MISFIT_H_
