// What is fitted of a prediction study, its model's parameters and what each recording leaves open,
// and what they leave of the frames that are fitted (calibration_fits.h: how they are found).
#ifndef LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_
#define LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/measurement_errors.h"
#include "analysis/series_noise.h"
#include "fit/calibration.h"
#include "prediction/predicted_motion.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// The misfit of the fitted recordings over all of their frames, held-out ones too, to first order
// about some values: rows of one recording after another, in m and not whitened.
struct LinearisedMisfit {
  struct Part {
    size_t recording = 0;  // of the study
    Eigen::Index first_row = 0;
    SeriesLayout layout;
    MeasurementErrors errors;
    std::vector<char> fitted;        // per frame
    Eigen::VectorXd speed;           // rows of d(predicted)/dt, m/s
    std::vector<Observed> observed;  // per frame: what it was compared with
  };
  bool usable = false;
  std::string message;
  Eigen::VectorXd residual;
  Eigen::MatrixXd by;  // columns: the problem's parameters, then the directions asked for
  std::vector<Part> parts;
};

// σ: a fit that leaves more may have ended at the wrong place.
inline constexpr double kMayBeAstray = 2;
// σ: a model that leaves more is far from the truth, and has other troubles than its elements'
// size.
inline constexpr double kFarOff = 3;

class CalibrationProblem {
 public:
  // Throws InputError when a region is empty or a scan does not show the object. The study must
  // outlive the problem.
  CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh);

  // The study's parameters, then the nuisances of each fitted recording.
  const std::vector<CalibratedParameter>& parameters() const { return parameters_; }
  const std::string& UnitOf(size_t parameter) const { return units_[parameter]; }  // SI
  Eigen::VectorXd Start() const;
  // σ of a marker's coordinate, and of a scanned point along the normal, m, that residuals are
  // weighed with; 0 where no recording has such.
  double noise() const { return noise_; }
  double scan_noise() const { return scan_noise_; }
  // As a part of that, the least variance that what models leave may tell of. An estimate from
  // eight frames at rest, and the larger one of two recordings, is up to 1.4 times too large, and a
  // model that leaves less has not found it by chance: its hundreds of rows fix σ to some per cent.
  double LeastNoiseVariance() const { return estimates_noise_ ? 0.25 : 1; }
  MeasurementErrors ErrorsOf(const RecordingModel& model) const;
  const PredictionStudy& study() const { return study_; }
  const std::vector<RecordingModel>& models() const { return models_; }
  const std::shared_ptr<const Body>& body() const { return body_; }
  bool HasScans() const { return scan_noise_ > 0; }
  // The study with what this problem has estimated or chosen (noise, patches), for another problem
  // whose misfit is to be compared with this one's; and the same with the effects at these values
  // of the problem's parameters.
  PredictionStudy WithEstimatedNoise() const;
  PredictionStudy StudyAt(const Eigen::VectorXd& values) const;
  // The model of a recording at these values of the problem's parameters.
  RecordingModel ModelAt(size_t recording, const Eigen::VectorXd& values) const;
  // A recording's nuisances: among the parameters where it is fitted; else found from its first
  // tenth, with the model at `values`.
  Eigen::VectorXd NuisanceOf(size_t recording, const Eigen::VectorXd& values) const;
  // Which recording tells the errors of the marker places of one that is not fitted: the first
  // fitted one that has markers of the same names at the same places. They are on the object, and
  // so the same in both. None where no recording has, and of scans.
  std::optional<size_t> PlacesToldBy(size_t recording) const;

  // What the predictions of one fit hand on from one to the next.
  struct FitMemory {
    // What the frames of each fitted recording are compared with; empty: found by the next
    // prediction that reaches the end.
    std::vector<std::vector<Observed>> correspondences;
    // Of each recording: the equilibrium before the motion, near which the next one is sought.
    std::vector<Eigen::VectorXd> equilibria;
  };

  // The whitened misfit over the fitted frames not later than `horizon` seconds after the start of
  // each recording, with derivatives by the parameters. Scanned points go with the places of the
  // surface nearest to them in this prediction or, where `memory` has correspondences, with those.
  // Not usable where most points of a scan have none. A function of its arguments alone: problems
  // and predictions may run side by side.
  Prediction Predict(const Eigen::VectorXd& values, bool with_jacobian,
                     double horizon = std::numeric_limits<double>::infinity(),
                     FitMemory* memory = nullptr) const;

  // `directions` are those of each recording alike; without a Jacobian only the residual is there.
  // Compared with what `same`, where given, was compared with.
  LinearisedMisfit Linearise(const Eigen::VectorXd& values, bool with_jacobian,
                             const std::vector<MisfitDirection>& directions = {},
                             const LinearisedMisfit* same = nullptr) const;

 private:
  // Those errors, 3 × markers, m.
  std::optional<Eigen::MatrixXd> PlacesFromFitted(size_t recording,
                                                  const Eigen::VectorXd& values) const;
  // What a recording's Misfit is differentiated by: the places of the study's parameters,
  // `further`, the recording's own nuisances; and those columns as ∂/∂(parameters), then by
  // `further` of them.
  std::vector<MisfitDirection> DirectionsFor(const RecordingModel& model,
                                             const std::vector<MisfitDirection>& further) const;
  Eigen::MatrixXd ColumnsOf(size_t recording, const Eigen::Ref<const Eigen::MatrixXd>& by,
                            Eigen::Index further) const;

  std::vector<size_t> FittedRecordings() const;
  // One recording's part of Predict() and of Linearise(); recordings are predicted side by side.
  // `misfit` is what the prediction was made from.
  Prediction PredictRecording(size_t recording, const Eigen::VectorXd& values, bool with_jacobian,
                              double horizon, const PredictionHints& hints, Misfit* misfit) const;
  struct LinearisedRecording {
    std::string message;  // why it is not usable; empty: it is
    LinearisedMisfit::Part part;
    Eigen::VectorXd residual;
    Eigen::MatrixXd by;
  };
  LinearisedRecording LineariseRecording(size_t recording, const Eigen::VectorXd& values,
                                         bool with_jacobian,
                                         const std::vector<MisfitDirection>& directions,
                                         const std::vector<Observed>* compared_with) const;

  const PredictionStudy& study_;
  std::shared_ptr<const Body> body_;
  SurfacePatches patches_;
  std::vector<RecordingModel> models_;
  std::vector<CalibratedParameter> parameters_;
  std::vector<std::string> units_;            // of the parameters
  std::vector<Eigen::Index> first_nuisance_;  // −1 for a recording that is not fitted
  double noise_ = 0, scan_noise_ = 0;
  bool estimates_noise_ = false;  // of markers, and there is nothing else
};

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_
