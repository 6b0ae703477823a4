// The fit of a prediction study: its model's parameters, and what each recording leaves open, to
// the frames that are fitted.
#ifndef LACUNA_STUDY_CALIBRATION_PROBLEM_H_
#define LACUNA_STUDY_CALIBRATION_PROBLEM_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "analysis/series_noise.h"
#include "core/progress.h"
#include "fit/calibration.h"
#include "study/predicted_motion.h"
#include "study/prediction_study.h"

namespace lacuna {

// How far predictions are from measurements in a set of frames. Distances are of markers, after the
// part of a marker's error that is its place on the object (Misfit) has been taken away.
struct MisfitMeasure {
  int frames = 0;
  int points = 0;       // markers seen, over all frames
  double rms = 0;       // m, of the distances
  double largest = 0;   // m
  double in_noise = 0;  // rms of the coordinates, in standard deviations of the noise
};

// The misfit of one recording at the solution, all frames.
struct RecordingMisfit {
  std::string name;
  Misfit misfit;
  std::vector<char> fitted;        // per frame of the misfit
  Eigen::Matrix3Xd place_offset;   // 3 × markers, m, what was taken for the markers' places
  MisfitMeasure in_fit, held_out;  // held out in time, or the whole recording
};

// The misfit of the fitted recordings over all of their frames, held-out ones too, to first order
// about some values: rows of one recording after another, in m and not whitened.
struct LinearisedMisfit {
  struct Part {
    size_t recording = 0;  // of the study
    Eigen::Index first_row = 0;
    SeriesLayout layout;
    std::vector<char> fitted;  // per frame
    Eigen::VectorXd speed;     // rows of d(predicted)/dt, m/s
  };
  bool usable = false;
  std::string message;
  Eigen::VectorXd residual;
  Eigen::MatrixXd by;  // columns: the problem's parameters, then the directions asked for
  std::vector<Part> parts;
};

class CalibrationProblem {
 public:
  // Throws InputError when the object cannot be meshed or a region is empty. The study must outlive
  // the problem.
  CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh);

  // The study's parameters, then the nuisances of each fitted recording.
  const std::vector<CalibratedParameter>& parameters() const { return parameters_; }
  Eigen::VectorXd Start() const;
  double noise() const { return noise_; }
  const PredictionStudy& study() const { return study_; }
  const std::vector<RecordingModel>& models() const { return models_; }
  const std::shared_ptr<const Body>& body() const { return body_; }
  // Recording r's nuisances: among the parameters where it is fitted; else found from its first
  // tenth, the model staying as `values` have set it (SetModel).
  Eigen::VectorXd NuisanceOf(size_t recording, const Eigen::VectorXd& values) const;

  // Gives the study's effects, which other problems may share and have changed, these values.
  void SetModel(const Eigen::VectorXd& values) const;

  // The whitened misfit over the fitted frames not later than `horizon` seconds after the start of
  // each recording, with derivatives by the parameters and by `more` (columns after them; the same
  // for each recording).
  Prediction Predict(const Eigen::VectorXd& values, bool with_jacobian,
                     double horizon = std::numeric_limits<double>::infinity(),
                     const std::vector<MisfitDirection>& more = {}) const;

  // `directions` are those of each recording alike; without a Jacobian only the residual is there.
  LinearisedMisfit Linearise(const Eigen::VectorXd& values, bool with_jacobian,
                             const std::vector<MisfitDirection>& directions = {}) const;

  // First over a short horizon, where a wrong model is least wrong, then over all fitted frames.
  Calibration Fit(const Eigen::VectorXd& start, Progress* progress,
                  const CalibrationOptions& options = {}) const;

  // All frames of every recording.
  std::vector<RecordingMisfit> Misfits(const Eigen::VectorXd& values) const;

 private:
  const PredictionStudy& study_;
  std::shared_ptr<const Body> body_;
  std::vector<RecordingModel> models_;
  std::vector<CalibratedParameter> parameters_;
  std::vector<Eigen::Index> first_nuisance_;  // −1 for a recording that is not fitted
  double noise_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_STUDY_CALIBRATION_PROBLEM_H_
