// The distance of a fitted model from each of its recordings, whether the recording was fitted or
// not.
#ifndef LACUNA_CALIBRATION_RECORDING_MISFIT_H_
#define LACUNA_CALIBRATION_RECORDING_MISFIT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"

namespace lacuna {

// The distance between predictions and measurements in a set of frames. It is measured at markers,
// or at patches of the surface along its normal, after the constant part of a point's error, which
// is that of its place on the object or of the object's shape, has been subtracted.
struct MisfitMeasure {
  int frames = 0;
  int points = 0;       // markers or patches seen, summed over the frames
  double rms = 0;       // m, rms distance
  double largest = 0;   // m
  double in_noise = 0;  // rms of the components, each divided by the σ of its noise
};

// The misfit of one recording over all of its frames.
struct RecordingMisfit {
  std::string name;
  Misfit misfit;
  Eigen::VectorXd nuisance;        // in the order of RecordingModel::nuisances
  std::vector<char> fitted;        // for each frame of the misfit
  Eigen::MatrixXd place_offset;    // components × points, m: the errors of the points' places
  bool has_own_places = true;      // false: the offsets are taken from a fitted recording
  MisfitMeasure in_fit, held_out;  // held out: later frames, or the whole recording
};

// The misfits of all recordings at these values of the problem's parameters. For a recording that
// is not fitted, the nuisances and the places are those of CalibrationProblem::NuisanceOf and
// PlacesToldBy.
std::vector<RecordingMisfit> MisfitsOf(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_RECORDING_MISFIT_H_
