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

// What is known before a prediction from others like it.
struct PredictionHints {
  // What each of the frames is compared with; null: what the observer makes of a frame at the
  // predicted positions.
  const std::vector<Observed>* observed = nullptr;
  // 3n, m: where the equilibrium before the motion is sought first, a tenth of the work near it;
  // null: at the rest shape. The result is the same within the tolerance of that equilibrium.
  const Eigen::VectorXd* near_equilibrium = nullptr;
};

// The model in the place of one recording.
class RecordingModel {
 public:
  // `patches`: of scans. Throws InputError
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

  // The same with other values of the study's effects: the first of model().effects, of the same
  // types and in the same order.
  RecordingModel With(const EffectList& effects) const;

  // The misfit in the chosen `frames` (ascending) with `nuisance` in the order of nuisances(), and
  // its derivatives in these directions. Depends on nothing but its arguments and this model, and
  // may run beside others.
  Misfit Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                 const std::vector<MisfitDirection>& directions = {},
                 const PredictionHints& hints = {}) const;

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

  std::shared_ptr<const Observer> observer_;
  double shown_ = 0;  // share of the first scan's points that the undeformed surface has
  std::vector<Nuisance> nuisances_;
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTED_MOTION_H_
