// The model of one recording, and its prediction of that recording.
#ifndef LACUNA_PREDICTION_RECORDING_MODEL_H_
#define LACUNA_PREDICTION_RECORDING_MODEL_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/observer.h"
#include "experiment/reference_body.h"
#include "fem/prediction.h"
#include "prediction/grip_placement.h"
#include "prediction/misfit.h"
#include "prediction/misfit_direction.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// Results of similar predictions, which save time.
struct PredictionHints {
  // What each of the frames is compared with. If it is null, the observer compares each frame with
  // the predicted positions.
  const std::vector<Observed>* observed = nullptr;
  // 3n, m: start of the search for the equilibrium before the motion; null: the rest shape, from
  // which the search takes ten times as long. The result is the same within the tolerance of that
  // equilibrium.
  const Eigen::VectorXd* near_equilibrium = nullptr;
  // Where the observer searches for the correspondences of scanned points, the factor on scan.reach
  // (Observer::ObserveWithin). Larger: a prediction farther away is compared with the scan.
  double reach_factor = 1;
};

// The model as one recording sees it: with the recording's grips, loads and own effects, and an
// observer that compares it with the measurements.
class RecordingModel {
 public:
  // `patches` divide the surface where the recording has scans. The study and the recording must
  // outlive the model. Throws InputError where a region holds no node, a scan lies where no
  // deformation can bring the object, or the object moves already in the first frame.
  RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                 const TetMesh& mesh, std::shared_ptr<const Body> body,
                 const SurfacePatches& patches);

  const PredictedRecording& recording() const { return recording_; }
  // What was measured.
  const Recording& measured() const { return recording_.recording; }
  // The time, s, of a frame, by its number in the recording.
  double FrameTime(int frame) const { return measured().times[static_cast<size_t>(frame)]; }
  const Model& model() const { return model_; }
  const Observer& observer() const { return *observer_; }
  int PointCount() const { return observer_->PointCount(); }
  // The measured reactions of the grips.
  const std::vector<MeasuredReaction>& Reactions() const {
    return recording_.recording.object.reactions;
  }
  // Null for a recording of scans.
  const MarkerObserver* Markers() const {
    return dynamic_cast<const MarkerObserver*>(observer_.get());
  }
  // A nuisance parameter of the recording: a component of the force that holds the body, the clock,
  // the delay of a load cell, or a component of the registration or of a grip's placement. It
  // starts at 0 unless the force is given.
  struct Nuisance {
    CalibratedParameter prior;
    MisfitDirection direction;
    std::string unit;  // SI
  };
  const std::vector<Nuisance>& nuisances() const { return nuisances_; }

  // This model with `effects` in place of the study's effects, which come first in model().effects
  // and have the same types in the same order.
  RecordingModel With(const EffectList& effects) const;

  // The misfit in the chosen `frames` (ascending) with `nuisance` in the order of nuisances(), and
  // its Jacobian in these directions. The result depends on the arguments and this model alone, so
  // that several threads may predict at once. `on_frame`, unless it is empty, is called whenever
  // one of the frames has been predicted. A simulation that stops early is reported in
  // Misfit::summary. Throws Interrupted.
  Misfit Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                 const std::vector<MisfitDirection>& directions = {},
                 const PredictionHints& hints = {},
                 const std::function<void()>& on_frame = {}) const;

  // The model whose grips have the placements of these nuisance parameters; that of the recording
  // where all placements are exact.
  Model PlacedModel(const Eigen::VectorXd& nuisance) const;
  // The options of a prediction with PlacedModel() and these nuisance parameters, and the delay, s,
  // of the recording's clock.
  PredictionOptions Options(const Eigen::VectorXd& nuisance) const;
  double Delay(const Eigen::VectorXd& nuisance) const;
  // The delay, s, of a load cell behind the recording's clock.
  double CellDelay(size_t reading, const Eigen::VectorXd& nuisance) const;
  // The transform from the fixture's coordinate system, which is the model's, to the recording's: a
  // rotation about the mean of the markers' places, then a translation.
  Eigen::Isometry3d Registration(const Eigen::VectorXd& nuisance) const;
  // The placement of a grip, by its index in Model::grips.
  GripPlacement PlacementOf(size_t grip, const Eigen::VectorXd& nuisance) const;
  // The derivative of a place in the recording's coordinates with respect to a translation or a
  // small rotation of the registration.
  Eigen::Vector3d RegistrationDerivative(const MisfitDirection& direction,
                                         const Eigen::Isometry3d& registration,
                                         const Eigen::Vector3d& place) const;
  // The frames of a scan in which too few points have a correspondence: fewer than `least` times
  // the share in the best frame, or in the first frame with the undeformed surface. Where the first
  // frame does not show the undeformed surface, because the object is deformed there, all points
  // are expected to have a correspondence.
  std::vector<int> LostFrames(const Misfit& misfit, double least) const;
  // Whether a frame of a scan shows enough patches of the predicted surface to be compared with it.
  bool Shows(const Observed& observed) const;

 private:
  void AddNuisances(const TetMesh& mesh);
  void AddHold(const TetMesh& mesh);
  void AddPlacements();
  void AddNuisance(const std::string& name, const std::string& unit, double deviation,
                   MisfitDirection direction);
  void RequireThatScansShowTheObject();
  // What a simulated direction perturbs with these nuisance parameters, with which `placed` is the
  // PlacedModel().
  Perturbation PerturbationOf(const MisfitDirection& direction, const Eigen::VectorXd& nuisance,
                              const Model& placed) const;
  Eigen::Vector3d Middle() const { return observer_->Places().rowwise().mean(); }

  const PredictionStudy& study_;
  const PredictedRecording& recording_;
  Model model_;
  std::shared_ptr<const Observer> observer_;
  // The share of the first scan's points that correspond to the undeformed surface; 1 where it does
  // not show that surface or, in a quasi-static study, where fewer than half of its points do.
  double shown_ = 0;
  std::vector<Nuisance> nuisances_;
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDING_MODEL_H_
