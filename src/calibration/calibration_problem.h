// The least-squares problem of a prediction study: its unknowns and its residual.
//
// The unknowns are the fitted parameters of the model and the nuisance parameters of each fitted
// recording (its holding force, its clock, its registration). The residual is predicted minus
// measured over the fitted frames, whitened by the measurement errors: of markers or scans, and of
// the reactions of the grips where these are measured. calibration_fits.h minimises it.
#ifndef LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_
#define LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/measurement_errors.h"
#include "calibration/linear_misfit.h"
#include "fit/calibration.h"
#include "prediction/prediction_study.h"
#include "prediction/recording_model.h"

namespace lacuna {

struct LineariseOptions {
  bool with_jacobian = false;
  // Further columns of the Jacobian, the same for each recording.
  std::vector<MisfitDirection> directions = {};
  // Where the scanned points get their correspondences from; null: from this prediction.
  const LinearisedMisfit* correspondences = nullptr;
  // The misfit of a similar model on the same mesh, from whose equilibria the search for those here
  // starts; null or not usable: from the rest shape.
  const LinearisedMisfit* near = nullptr;
  // Called whenever a frame has been predicted, by several threads at once; empty: it is not.
  std::function<void()> on_frame = {};
};

// A fit whose rms residual exceeds this many σ may have ended in a local minimum; other starts are
// tried. Lower: more fits are repeated; higher: more local minima are kept.
inline constexpr double kLocalMinimumSuspected = 2;
// A model whose rms residual exceeds this many σ is far from the truth; the error of its mesh does
// not matter then.
inline constexpr double kFarFromTruth = 3;

// What fitted recordings tell about the errors of the places of their markers, by the numbers of
// CalibrationProblem::PlaceIds().
struct PlaceErrors {
  CommonErrors errors;
  std::vector<char> is_told;  // for each place, whether a recording that was added shows it
};

class CalibrationProblem {
 public:
  // Throws InputError when a region is empty or a scan does not show the object. The study must
  // outlive the problem.
  CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh);

  // The study's parameters, then the nuisances of each fitted recording.
  const std::vector<CalibratedParameter>& parameters() const { return parameters_; }
  const std::string& UnitOf(size_t parameter) const { return units_[parameter]; }  // SI unit
  // Whether a parameter is a modulus, of which a search for the start tries multiples.
  bool IsModulus(size_t parameter) const {
    return parameters_[parameter].log_scale && units_[parameter] == "Pa";
  }
  Eigen::VectorXd Start() const;
  // The standard deviations that whiten the residuals, m: of a marker's coordinate, and of a
  // scanned point along the surface normal. 0 where no recording has markers or scans,
  // respectively.
  double noise() const { return noise_; }
  double scan_noise() const { return scan_noise_; }
  // The smallest variance of the noise that residuals of models may imply, relative to noise()².
  // noise() may be up to 1.4 times too large where it was estimated from eight frames at rest, or
  // where it is the larger estimate of two recordings, while the hundreds of rows of a residual
  // determine σ within a few per cent.
  double LeastNoiseVariance() const { return estimates_noise_ ? 0.25 : 1; }
  MeasurementErrors ErrorsOf(const RecordingModel& model) const;
  const PredictionStudy& study() const { return study_; }
  const std::vector<RecordingModel>& models() const { return models_; }
  const std::shared_ptr<const Body>& body() const { return body_; }
  bool HasScans() const { return scan_noise_ > 0; }
  // The study with the noise and the patches that this problem has estimated or chosen, for another
  // problem whose residual is to be compared with this one's.
  PredictionStudy WithEstimatedNoise() const;
  // The study with its effects at these values of the problem's parameters.
  PredictionStudy StudyAt(const Eigen::VectorXd& values) const;
  // The model of a recording at these values of the problem's parameters.
  RecordingModel ModelAt(size_t recording, const Eigen::VectorXd& values) const;
  // The nuisance parameters of a recording. Those of a fitted recording are among `values`; those
  // of another one are fitted to its first tenth, with the model at `values`.
  Eigen::VectorXd NuisanceOf(size_t recording, const Eigen::VectorXd& values) const;
  // The numbers of the places of a recording's markers. Markers of several recordings with the same
  // name and place, which is known equally well in them, sit at one place of the object. They have
  // the same number, and the same error of that place. Empty for scans.
  const std::vector<int>& PlaceIds(size_t recording) const { return place_ids_[recording]; }
  // Whether two recordings show a marker at the same place.
  bool ShareMarkers(size_t a, size_t b) const;
  // The errors of the places before any recording has been added; adds those that the fitted frames
  // of a recording show; whether recordings were added that show all places of this one.
  PlaceErrors NoPlaceErrors() const;
  void AddTo(PlaceErrors* places, size_t recording, const Misfit& misfit) const;
  bool AreTold(const PlaceErrors& places, size_t recording) const;

  // What the predictions of a fit reuse from earlier ones.
  struct FitMemory {
    // For each recording, what its frames are compared with. If it is empty, the next prediction
    // that succeeds fills it in.
    std::vector<std::vector<Observed>> correspondences;
    // For each recording, the equilibrium before the motion (3n, m), from which the search for the
    // next one starts.
    std::vector<Eigen::VectorXd> equilibria;
    // Factor on scan.reach for the next search for correspondences. With a factor above 1 it does
    // not matter how many scanned points find one.
    double reach_factor = 1;
  };

  // The whitened residual over the fitted frames up to `horizon` seconds after the start of each
  // recording, and its Jacobian. Scanned points correspond to the nearest places of the surface in
  // this prediction, unless `memory` already holds correspondences. Not usable, with a message,
  // where the simulation stops early or most points of a scan have no correspondence. The result
  // depends on the arguments alone, so that several threads may predict at once. Throws
  // Interrupted.
  ResidualEvaluation Predict(const Eigen::VectorXd& values, bool with_jacobian,
                             double horizon = std::numeric_limits<double>::infinity(),
                             FitMemory* memory = nullptr) const;

  // How far the fitted frames of scans are from the surface that is predicted at `values`.
  struct ScanDistance {
    double mean = 0;  // m, over frames, of Observed::distance
    double used = 0;  // the share of the points with a correspondence within scan.reach
  };
  // Empty where a simulation stops early. Equilibria are taken from `memory` and kept there. Throws
  // Interrupted.
  std::optional<ScanDistance> DistanceOfScans(const Eigen::VectorXd& values,
                                              FitMemory* memory) const;

  // The number of frames that Linearise() predicts.
  int64_t LinearisedFrames() const;
  // Predicts all frames of the fitted recordings. Throws Interrupted.
  LinearisedMisfit Linearise(const Eigen::VectorXd& values,
                             const LineariseOptions& options = {}) const;

 private:
  // The errors of the marker places of a recording that is not fitted, 3 × markers, m, as the
  // fitted recordings of the same markers tell them; empty where there are none.
  std::optional<Eigen::MatrixXd> PlacesFromFitted(size_t recording,
                                                  const Eigen::VectorXd& values) const;
  // The directions in which a recording's Misfit is differentiated: each place of the study's
  // parameters, then `further`, then the recording's own nuisances. ColumnsOf() gathers these
  // columns into ∂/∂(parameters), followed by the `further` ones.
  std::vector<MisfitDirection> DirectionsFor(const RecordingModel& model,
                                             const std::vector<MisfitDirection>& further) const;
  Eigen::MatrixXd ColumnsOf(size_t recording, const Eigen::Ref<const Eigen::MatrixXd>& by,
                            Eigen::Index further) const;

  void NumberPlaces();
  std::vector<size_t> FittedRecordings() const;
  // The rows of one recording; recordings are predicted side by side, and joined.
  struct FrameRequest {
    size_t recording = 0;
    std::vector<int> frames;
    PredictionHints hints = {};
    bool needs_matches = false;  // not usable where most points of a scan have no correspondence
  };
  struct PredictedRows {
    std::string message;  // the reason why it is not usable; empty where it is
    std::vector<LinearisedMisfit::Part> parts;  // first_row counts from that of the recording
    Eigen::VectorXd residual;
    Eigen::MatrixXd jacobian;
  };
  PredictedRows RowsOf(const FrameRequest& request, const Eigen::VectorXd& values,
                       const LineariseOptions& options) const;
  static LinearisedMisfit Joined(std::vector<PredictedRows> recordings);

  const PredictionStudy& study_;
  std::shared_ptr<const Body> body_;
  SurfacePatches patches_;
  std::vector<RecordingModel> models_;
  std::vector<CalibratedParameter> parameters_;
  std::vector<std::string> units_;            // SI units of the parameters
  std::vector<Eigen::Index> first_nuisance_;  // −1 for a recording that is not fitted
  std::vector<std::vector<int>> place_ids_;   // PlaceIds() of each recording
  int place_count_ = 0;                       // the number of different places
  double noise_ = 0, scan_noise_ = 0;
  bool estimates_noise_ = false;  // whether noise_ was estimated; false where there are scans
};

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_PROBLEM_H_
