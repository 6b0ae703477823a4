// What the model of a prediction study predicts of its recordings, and how far off that is.
#ifndef LACUNA_PREDICTION_PREDICTED_MOTION_H_
#define LACUNA_PREDICTION_PREDICTED_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "experiment/observer.h"
#include "experiment/reference_body.h"
#include "fem/prediction.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// Predicted minus measured, m, of one recording: the components (Observer) of each point, marker or
// patch, of each frame, frames outermost. Rows of a point that was not seen are 0.
struct Misfit {
  std::vector<int> frames;   // of the recording, as far as the prediction came
  int points = 0;            // of each frame
  Eigen::VectorXd residual;  // components·points·frames
  Eigen::MatrixXd by;      // ∂residual/∂(parameter), rows × columns; 0 columns: not asked for
  std::vector<int> count;  // points × frames: measurements that each is the mean of; 0: not seen
  // points × frames: F (Observed), turned into the measuring frame; empty of scans.
  std::vector<Eigen::Matrix3d> deformation;
  std::vector<Observed> observed;  // of each frame: what the prediction was compared with
  PredictionSummary summary;

  Eigen::Index Components() const {
    return count.empty() ? 0 : residual.size() / static_cast<Eigen::Index>(count.size());
  }
  // The residual less what errors of the points' places (components × points, m) show as.
  Eigen::VectorXd ResidualWithout(const Eigen::MatrixXd& place_offset) const;
};

// Of one column of a Misfit's derivative.
struct MisfitDirection {
  // Of the model; or of the recording: its clock runs late by the parameter, s; or its measuring
  // frame is shifted, m, or turned, rad, along an axis.
  enum class Of { kModel, kClock, kShift, kTurn };
  Of of = Of::kModel;
  int axis = 0;
  Perturbation perturbation = {};  // of the model
};

// The model in the place of one recording.
class RecordingModel {
 public:
  // `effects`: the study's, shared between its recordings; `patches`: of scans. Throws InputError
  // when a region holds no node, a scan misses the object or is one of an object that moves
  // already.
  RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                 const TetMesh& mesh, std::shared_ptr<const Body> body,
                 const SurfacePatches& patches);

  const PredictedRecording& item() const { return item_; }
  const Model& model() const { return model_; }
  const Observer& observer() const { return *observer_; }
  int PointCount() const { return observer_->PointCount(); }
  // Null of a recording of scans.
  const MarkerObserver* Markers() const {
    return dynamic_cast<const MarkerObserver*>(observer_.get());
  }
  // What the recording itself leaves open: three components of the force that holds the body, the
  // clock, the registration. `prior` is by name and deviation; start 0.
  struct Nuisance {
    CalibratedParameter prior;
    MisfitDirection direction;
    std::string unit;  // SI
  };
  const std::vector<Nuisance>& nuisances() const { return nuisances_; }

  // With the effects as they are, `nuisance` in the order of nuisances(), for the chosen `frames`
  // (ascending). Compared with `observed`, one for each frame, or, null, with what the observer
  // makes of the frames at the predicted positions.
  Misfit Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                 const std::vector<MisfitDirection>& directions,
                 const std::vector<Observed>* observed = nullptr) const;

  std::vector<int> FittedFrames() const;

  // How the model is run with these nuisances, and by how much, s, the recording's clock is late.
  PredictionOptions Options(const Eigen::VectorXd& nuisance) const;
  double Delay(const Eigen::VectorXd& nuisance) const;
  // From the fixture, in which the model is, to the recording's measuring frame: turned about the
  // middle of the markers' places, then shifted.
  Eigen::Isometry3d Registration(const Eigen::VectorXd& nuisance) const;
  // ∂(a place in the measuring frame)/∂(a shift or turn), the turn small.
  Eigen::Vector3d ByRegistration(const MisfitDirection& direction,
                                 const Eigen::Isometry3d& registration,
                                 const Eigen::Vector3d& place) const;
  // In which frames of a scan points found no place on the predicted surface: fewer than `least`
  // times the share that did in the best frame, or in the first with the undeformed surface.
  std::vector<int> LostFrames(const Misfit& misfit, double least) const;

 private:
  const PredictionStudy& study_;
  const PredictedRecording& item_;
  Model model_;
  void AddHold(const TetMesh& mesh);
  void AddNuisance(const std::string& name, const std::string& unit, double deviation,
                   MisfitDirection direction);
  void RequireThatScansShowTheObject();
  Eigen::Vector3d Middle() const { return observer_->Places().rowwise().mean(); }

  std::unique_ptr<const Observer> observer_;
  double shown_ = 0;  // share of the first scan's points that the undeformed surface has
  std::vector<Nuisance> nuisances_;
  mutable Eigen::VectorXd held_;  // 3n, m: the last equilibrium; the next one is sought from there
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTED_MOTION_H_
