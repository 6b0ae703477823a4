#include "calibration/calibration_problem.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "prediction/recording_noise.h"
#include "prediction/recording_nuisances.h"
#include "prediction/setting_derivative.h"

namespace lacuna {
namespace {

std::vector<MisfitDirection> DirectionsOf(const std::vector<ModelParameter>& parameters,
                                          const EffectList& effects) {
  std::vector<MisfitDirection> directions;
  for (const ModelParameter& parameter : parameters)
    for (const auto& [effect, index] : parameter.places)
      directions.push_back({.perturbation = ParameterPerturbation(effects[effect], index)});
  return directions;
}

// Adds up the columns of the places of each parameter.
Eigen::MatrixXd SumOverPlaces(const std::vector<ModelParameter>& parameters,
                              const Eigen::MatrixXd& by) {
  Eigen::MatrixXd sum =
      Eigen::MatrixXd::Zero(by.rows(), static_cast<Eigen::Index>(parameters.size()));
  Eigen::Index column = 0;
  for (size_t k = 0; k < parameters.size(); ++k)
    for (size_t place = 0; place < parameters[k].places.size(); ++place)
      sum.col(static_cast<Eigen::Index>(k)) += by.col(column++);
  return sum;
}

// The reason why the noise of markers cannot be estimated from the fitted frames.
std::string WhyWithoutNoise(const std::vector<RecordingModel>& models) {
  constexpr size_t kFewestFrames = 3;  // noise shows in second differences
  size_t most = 0;
  for (const RecordingModel& model : models)
    if (!model.recording().ShowsScans())
      most = std::max(most, model.recording().FittedFrames().size());
  if (most == 0) return "no recording of markers is fitted";
  if (most < kFewestFrames) return "fewer than three frames of markers are fitted";
  return "no marker is seen in three frames that follow one another, or their values contain no "
         "noise: the markers do not move at all, or along a straight line";
}

}  // namespace

CalibrationProblem::CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh)
    : study_(study),
      body_(std::make_shared<const Body>(MakeBody(mesh, study.density))),
      patches_(study.patches),
      noise_(study.noise) {
  for (const ModelParameter& parameter : study.fitted) {
    parameters_.push_back(parameter.prior);
    units_.push_back(parameter.unit);
  }
  const bool has_scans =
      std::any_of(study.recordings.begin(), study.recordings.end(),
                  [](const PredictedRecording& item) { return item.ShowsScans(); });
  if (has_scans && patches_.Count() == 0)
    patches_ = DivideSurface(body_->boundary.surface, study.scan.patches);
  double of_markers = 0, of_scans = 0;
  bool has_markers = false;
  for (const PredictedRecording& item : study.recordings) {
    models_.emplace_back(study, item, mesh, body_, patches_);
    first_nuisance_.push_back(item.fitted ? static_cast<Eigen::Index>(parameters_.size()) : -1);
    if (item.fitted)
      for (const auto& nuisance : models_.back().nuisances()) {
        parameters_.push_back(nuisance.prior);
        units_.push_back(nuisance.unit);
      }
    has_markers = has_markers || !item.ShowsScans();
    double& largest = item.ShowsScans() ? of_scans : of_markers;
    largest = std::max(largest, EstimateRecordingNoise(item, item.FittedFrames()));
  }
  for (CalibratedParameter& parameter : parameters_)
    if (std::isnan(parameter.prior_mean)) parameter.prior_mean = parameter.start;
  estimates_noise_ = !has_scans && (noise_ == 0 || study.noise_is_estimated);
  if (noise_ == 0 || !has_markers) noise_ = of_markers;
  if (has_markers && !(noise_ > 0)) {
    throw InputError(fmt::format("{}: noise: cannot be estimated ({}); give it",
                                 study.file.string(), WhyWithoutNoise(models_)));
  }
  NumberPlaces();
  if (!has_scans) return;
  scan_noise_ = study.scan.noise > 0 ? study.scan.noise : of_scans;
  if (!(scan_noise_ > 0)) {
    throw InputError(fmt::format(
        "{}: scan.noise: cannot be estimated (no scan is fitted, or its points lie on planes); "
        "give it",
        study.file.string()));
  }
}

void CalibrationProblem::NumberPlaces() {
  constexpr double kSamePlace = 1e-9;  // m: places that were written in two units may be rounded
  struct KnownPlace {
    int id;
    Eigen::Vector3d place;
    double deviation;
  };
  std::multimap<std::string, KnownPlace> known;  // by the marker's name
  for (const RecordingModel& model : models_) {
    std::vector<int>& ids = place_ids_.emplace_back();
    const PredictedRecording& item = model.recording();
    if (item.ShowsScans()) continue;
    const Markers& markers = item.recording.markers;
    const double deviation = ErrorsOf(model).common;
    for (size_t m = 0; m < markers.names.size(); ++m) {
      const Eigen::Vector3d place = markers.places.col(static_cast<Eigen::Index>(m));
      const auto [first, last] = known.equal_range(markers.names[m]);
      auto same = std::find_if(first, last, [&](const auto& other) {
        return other.second.deviation == deviation &&
               (other.second.place - place).norm() <= kSamePlace;
      });
      if (same == last)
        same = known.emplace(markers.names[m], KnownPlace{place_count_++, place, deviation});
      ids.push_back(same->second.id);
    }
  }
}

MeasurementErrors CalibrationProblem::ErrorsOf(const RecordingModel& model) const {
  if (model.recording().ShowsScans()) return {scan_noise_, study_.scan.shape_deviation};
  return {noise_, PlaceDeviation(study_, model.recording(), noise_)};
}

PredictionStudy CalibrationProblem::WithEstimatedNoise() const {
  PredictionStudy given = study_;
  given.noise = noise_;
  given.noise_is_estimated = estimates_noise_;
  given.scan.noise = scan_noise_;
  given.patches = patches_;
  return given;
}

Eigen::VectorXd CalibrationProblem::Start() const {
  Eigen::VectorXd start(static_cast<Eigen::Index>(parameters_.size()));
  for (size_t k = 0; k < parameters_.size(); ++k)
    start[static_cast<Eigen::Index>(k)] = parameters_[k].start;
  return start;
}

PredictionStudy CalibrationProblem::StudyAt(const Eigen::VectorXd& values) const {
  PredictionStudy study = WithEstimatedNoise();
  study.effects = WithValues(study_.effects, study_.fitted, values);
  return study;
}

RecordingModel CalibrationProblem::ModelAt(size_t recording, const Eigen::VectorXd& values) const {
  return models_[recording].With(WithValues(study_.effects, study_.fitted, values));
}

Eigen::VectorXd CalibrationProblem::NuisanceOf(size_t recording,
                                               const Eigen::VectorXd& values) const {
  const RecordingModel& model = models_[recording];
  if (first_nuisance_[recording] >= 0)
    return values.segment(first_nuisance_[recording],
                          static_cast<Eigen::Index>(model.nuisances().size()));
  return FitRecordingNuisances(ModelAt(recording, values), ErrorsOf(model),
                               PlacesFromFitted(recording, values));
}

bool CalibrationProblem::ShareMarkers(size_t a, size_t b) const {
  const std::vector<int>&first = place_ids_[a], &second = place_ids_[b];
  return std::find_first_of(first.begin(), first.end(), second.begin(), second.end()) !=
         first.end();
}

PlaceErrors CalibrationProblem::NoPlaceErrors() const {
  return {CommonErrors(3, place_count_), std::vector<char>(static_cast<size_t>(place_count_))};
}

void CalibrationProblem::AddTo(PlaceErrors* places, size_t recording, const Misfit& misfit) const {
  std::vector<char> fitted;
  for (const int frame : misfit.frames)
    fitted.push_back(models_[recording].recording().IsFitted(frame));
  places->errors.Add(misfit.residual, misfit.count, ErrorsOf(models_[recording]), fitted,
                     misfit.deformation, place_ids_[recording]);
  for (const int place : place_ids_[recording]) places->is_told[static_cast<size_t>(place)] = 1;
}

bool CalibrationProblem::AreTold(const PlaceErrors& places, size_t recording) const {
  const std::vector<int>& ids = place_ids_[recording];
  return !ids.empty() && std::all_of(ids.begin(), ids.end(), [&](int place) {
    return places.is_told[static_cast<size_t>(place)] != 0;
  });
}

std::optional<Eigen::MatrixXd> CalibrationProblem::PlacesFromFitted(
    size_t recording, const Eigen::VectorXd& values) const {
  std::vector<size_t> sources;
  for (const size_t r : FittedRecordings())
    if (ShareMarkers(recording, r)) sources.push_back(r);
  std::vector<Misfit> misfits(sources.size());
  ParallelFor(static_cast<int64_t>(sources.size()), 1, [&](int64_t k) {
    const RecordingModel fitted = ModelAt(sources[static_cast<size_t>(k)], values);
    misfits[static_cast<size_t>(k)] = fitted.Predict(
        fitted.recording().FittedFrames(), NuisanceOf(sources[static_cast<size_t>(k)], values));
  });
  PlaceErrors places = NoPlaceErrors();
  for (size_t k = 0; k < sources.size(); ++k)
    if (misfits[k].summary.IsUsable()) AddTo(&places, sources[k], misfits[k]);
  if (!AreTold(places, recording)) return std::nullopt;
  return places.errors.Mean()(Eigen::all, place_ids_[recording]);
}

std::vector<MisfitDirection> CalibrationProblem::DirectionsFor(
    const RecordingModel& model, const std::vector<MisfitDirection>& further) const {
  std::vector<MisfitDirection> directions = DirectionsOf(study_.fitted, model.model().effects);
  directions.insert(directions.end(), further.begin(), further.end());
  for (const auto& nuisance : model.nuisances()) directions.push_back(nuisance.direction);
  return directions;
}

Eigen::MatrixXd CalibrationProblem::ColumnsOf(size_t recording,
                                              const Eigen::Ref<const Eigen::MatrixXd>& by,
                                              Eigen::Index further) const {
  const Eigen::Index own = static_cast<Eigen::Index>(models_[recording].nuisances().size());
  const Eigen::Index places = by.cols() - further - own;
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(by.rows(), static_cast<Eigen::Index>(parameters_.size()) + further);
  columns.leftCols(static_cast<Eigen::Index>(study_.fitted.size())) =
      SumOverPlaces(study_.fitted, by.leftCols(places));
  columns.rightCols(further) = by.middleCols(places, further);
  columns.middleCols(first_nuisance_[recording], own) = by.rightCols(own);
  return columns;
}

std::vector<size_t> CalibrationProblem::FittedRecordings() const {
  std::vector<size_t> fitted;
  for (size_t r = 0; r < models_.size(); ++r)
    if (first_nuisance_[r] >= 0) fitted.push_back(r);
  return fitted;
}

ResidualEvaluation CalibrationProblem::Predict(const Eigen::VectorXd& values, bool with_jacobian,
                                               double horizon, FitMemory* memory) const {
  ThrowIfInterrupted();
  FitMemory nothing;
  FitMemory& known = memory != nullptr ? *memory : nothing;
  const bool seek = known.correspondences.empty();
  known.equilibria.resize(models_.size());
  const std::vector<size_t> fitted = FittedRecordings();
  std::vector<PredictedRows> recordings(fitted.size());
  ParallelFor(static_cast<int64_t>(fitted.size()), 1, [&](int64_t k) {
    const size_t r = fitted[static_cast<size_t>(k)];
    const PredictedRecording& item = models_[r].recording();
    FrameRequest early{
        r,
        item.FittedFrames(),
        {seek ? nullptr : &known.correspondences[r], &known.equilibria[r], known.reach_factor},
        /*needs_matches=*/known.reach_factor <= 1};
    std::erase_if(early.frames, [&](int frame) {
      return models_[r].FrameTime(frame) > item.StartTime() + horizon;
    });
    recordings[static_cast<size_t>(k)] = RowsOf(early, values, {.with_jacobian = with_jacobian});
  });
  LinearisedMisfit all = Joined(std::move(recordings));
  // The result of the next prediction must not depend on one that has failed.
  if (!all.usable) return {false, all.message, {}, {}};
  if (seek) known.correspondences.resize(models_.size());
  for (LinearisedMisfit::Part& part : all.parts) {
    if (!part.IsOfPoints()) continue;
    if (part.held.size() > 0) known.equilibria[part.recording] = std::move(part.held);
    if (seek) known.correspondences[part.recording] = std::move(part.observed);
  }
  return FittedEvaluation(all);
}

std::optional<CalibrationProblem::ScanDistance> CalibrationProblem::DistanceOfScans(
    const Eigen::VectorXd& values, FitMemory* memory) const {
  memory->equilibria.resize(models_.size());
  ScanDistance distance;
  double frames = 0, offered = 0;
  for (const size_t r : FittedRecordings()) {
    if (!models_[r].recording().ShowsScans()) continue;
    ThrowIfInterrupted();
    const RecordingModel model = ModelAt(r, values);
    const Misfit misfit = model.Predict(model.recording().FittedFrames(), NuisanceOf(r, values), {},
                                        {.near_equilibrium = &memory->equilibria[r]});
    if (!misfit.summary.IsUsable()) return std::nullopt;
    memory->equilibria[r] = misfit.summary.held;
    for (const Observed& observed : misfit.observed) {
      distance.mean += observed.distance;
      distance.used += observed.used;
      offered += observed.offered;
      ++frames;
    }
  }
  if (frames > 0) distance.mean /= frames;
  if (offered > 0) distance.used /= offered;
  return distance;
}

}  // namespace lacuna
