// What the model of a prediction study predicts of its recordings, and how far off that is.
#ifndef LACUNA_STUDY_PREDICTED_MOTION_H_
#define LACUNA_STUDY_PREDICTED_MOTION_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "fem/prediction.h"
#include "geometry/embedding.h"
#include "study/prediction_study.h"
#include "study/reference.h"

namespace lacuna {

// Predicted minus measured, m, of one recording: three rows (x, y, z) for each marker of each
// frame, frames outermost. Rows of a marker that was not seen are 0.
struct Misfit {
  std::vector<int> frames;   // of the recording, as far as the prediction came
  Eigen::VectorXd residual;  // 3·markers·frames
  Eigen::MatrixXd by;  // ∂residual/∂(parameter), rows × columns; 0 columns: not asked for
  std::vector<char> observed;  // markers × frames
  PredictionSummary summary;
};

// Of one column of a Misfit's derivative.
struct MisfitDirection {
  Perturbation perturbation;
  bool is_clock = false;  // the recording's clock runs late by the parameter, s
};

// The model in the place of one recording.
class RecordingModel {
 public:
  // `effects`: the study's, shared between its recordings. Throws InputError when a region holds no
  // node.
  RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                 const TetMesh& mesh, std::shared_ptr<const Body> body);

  const PredictedRecording& item() const { return item_; }
  const Model& model() const { return model_; }
  int MarkerCount() const { return static_cast<int>(places_.tet.size()); }
  // What the recording itself leaves open: three components of the force that holds the body, the
  // clock. `prior` is by name and deviation; start 0.
  struct Nuisance {
    CalibratedParameter prior;
    MisfitDirection direction;
  };
  const std::vector<Nuisance>& nuisances() const { return nuisances_; }

  // With the effects as they are, `nuisance` in the order of nuisances(), for the chosen `frames`
  // (ascending).
  Misfit Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                 const std::vector<MisfitDirection>& directions) const;

  std::vector<int> FittedFrames() const;

  const Embedding& places() const { return places_; }  // of the markers, in the body's mesh
  // How the model is run with these nuisances, and by how much, s, the recording's clock is late.
  PredictionOptions Options(const Eigen::VectorXd& nuisance) const;
  double Delay(const Eigen::VectorXd& nuisance) const;

 private:
  const PredictionStudy& study_;
  const PredictedRecording& item_;
  Model model_;
  Embedding places_;
  std::vector<Nuisance> nuisances_;
};

// Rows of points (x, y, z each) from rows of nodes: Σ_a weight_a · x_a.
Eigen::MatrixXd AtMarkers(const Embedding& places, const TetMesh& mesh,
                          const Eigen::MatrixXd& nodal);

// Rows divided by the noise, and what is common to all frames of a marker's coordinate weighed
// down: the covariance is σ² I + s² 1 1ᵀ for each, as the marker's place on the object is known to
// s only. Applied to a residual or to the columns of its derivative.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<char>& observed,
                         int markers, double noise, double place_deviation);

// The white part of a recording's noise, m, from the second differences of its coordinates in these
// frames (ascending): the median over the markers. 0 of fewer than three frames.
double EstimateMarkerNoise(const PredictedRecording& item, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_STUDY_PREDICTED_MOTION_H_
