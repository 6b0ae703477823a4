// Errors of a model's predictions against the measurements, as plain data.
//
// A residual is predicted minus measured: the displacement of a marker, or the distance of a
// surface patch along its normal. σ is the standard deviation of the measurement noise.
#ifndef LACUNA_RECORD_MODEL_ERRORS_H_
#define LACUNA_RECORD_MODEL_ERRORS_H_

#include <cmath>
#include <string>

namespace lacuna {

// The residuals of a set of frames of one recording. The part of a point's residual that is common
// to all frames (the error of its place on the object, or of the object's shape) is not counted.
struct MisfitMeasure {
  int frames = 0;
  int points = 0;             // markers or patches observed, summed over the frames
  double rms = 0;             // m, rms length of the residual
  double largest = 0;         // m, largest length of the residual
  double rms_over_sigma = 0;  // rms of the components, each divided by its σ; 1 is noise alone
  // m, as rms, with each point at the place where it was measured: the common part is counted.
  double rms_at_measured_places = 0;
};

// The residuals of a model over all recordings of a study.
struct ModelErrors {
  double in_fit_rms = 0, held_out_rms = 0;  // m, fitted and held-out frames
  double rms_over_sigma = 0;                // held-out frames, components divided by σ
  // rms_over_sigma of the held-out frames of the fitted recordings only, after the adopted
  // nuisances (mesh, time step, grip placement) have taken their best values.
  double without_nuisances = 0;
  double unfitted_rms_over_sigma = 0;  // recordings that were not fitted; 0 if there are none
  // m, as held_out_rms, with the points at the places where they were measured. Known for fits
  // only.
  double held_out_at_measured_places = 0;
  bool has_held_out = false;  // if nothing was held out, the fitted frames are used
  // The sum of the squares of the residuals of the recordings that were not fitted, each divided by
  // its σ. Not in files.
  double unfitted_squares = 0;
};

// The rms length of the noise of a marker's position, √3 `sigma`, where `sigma` is the standard
// deviation of each coordinate; in the unit of `sigma`.
inline double RmsOfMarkerNoise(double sigma) { return std::sqrt(3.0) * sigma; }

// Whether all points have the noise of a typical one, which alone would give the rms length
// `noise_rms`: `rms_over_sigma`, the rms error in units of each point's own noise, is then
// `rms`/`noise_rms`. Points with weights, and patches that are means of different numbers of
// scanned points, have noise of their own.
inline bool HaveEqualNoise(double rms, double rms_over_sigma, double noise_rms) {
  constexpr double kOtherNoise = 0.02;  // relative; larger: more differences count as rounding
  return std::abs(rms_over_sigma * noise_rms - rms) <= kOtherNoise * rms;
}

// An effect, or a nuisance, that a diagnosis could not try with these recordings or with one of
// them.
struct UntriedEffect {
  std::string type;  // or the name of the nuisance
  std::string why;
};

}  // namespace lacuna

#endif  // LACUNA_RECORD_MODEL_ERRORS_H_
