#include "calibration/calibration_problem.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "prediction/recording_noise.h"
#include "prediction/recording_nuisances.h"
#include "prediction/setting_derivative.h"

namespace lacuna {
namespace {

// A frame is lost where the share of its points with a correspondence is less than this fraction of
// the share in the best frame.
constexpr double kFewestMatched = 0.5;

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

// The reason why the correspondences of a scan cannot be used; empty where they can.
std::string Mismatch(const RecordingModel& model, const Misfit& misfit) {
  const size_t lost = model.LostFrames(misfit, kFewestMatched).size();
  if (2 * lost <= misfit.frames.size()) {
    if (!model.recording().ShowsScans() || misfit.observed.empty()) return "";
    const Observed& first = misfit.observed.front();
    if (model.Shows(first)) return "";
    return fmt::format(
        "frame {} shows {} of {} patches of the predicted surface: the length unit of its points, "
        "their transform or their normals are wrong, or it shows too little of the object",
        misfit.frames.front(), (first.count.array() > 0).count(), misfit.points);
  }
  return fmt::format(
      "in {} of {} frames most scanned points are farther than scan.reach from the predicted "
      "surface: start nearer to the solution, increase scan.reach, or crop the scans to the object",
      lost, misfit.frames.size());
}

// The rows of `more` appended to those of `all`.
void AppendRows(const Eigen::MatrixXd& more, Eigen::MatrixXd* all) {
  const Eigen::Index rows = all->rows();
  all->conservativeResize(rows + more.rows(), more.cols());
  all->bottomRows(more.rows()) = more;
}

// Appends whitened rows to a prediction. `series`: rows of one frame. `count`: for each point (or
// each component of a reaction) in each frame, 0 where it was not observed.
void AppendWhitened(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& jacobian,
                    Eigen::Index series, const std::vector<double>& count,
                    ResidualEvaluation* prediction) {
  const Eigen::Index first = prediction->residual.size();
  if (!count.empty())
    prediction->unobserved += residual.rows() / static_cast<Eigen::Index>(count.size()) *
                              std::count(count.begin(), count.end(), 0);
  prediction->residual.conservativeResize(first + residual.rows());
  prediction->residual.tail(residual.rows()) = residual.col(0);
  AppendRows(jacobian, &prediction->jacobian);
  for (Eigen::Index row = 0; row < residual.rows(); ++row)
    prediction->before.push_back(row < series ? -1 : first + row - series);
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
  if (!has_scans) return;
  scan_noise_ = study.scan.noise > 0 ? study.scan.noise : of_scans;
  if (!(scan_noise_ > 0)) {
    throw InputError(fmt::format(
        "{}: scan.noise: cannot be estimated (no scan is fitted, or its points lie on planes); "
        "give it",
        study.file.string()));
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

std::optional<size_t> CalibrationProblem::RecordingWithSamePlaces(size_t recording) const {
  if (models_[recording].recording().ShowsScans() || first_nuisance_[recording] >= 0)
    return std::nullopt;
  for (size_t r = 0; r < models_.size(); ++r)
    if (first_nuisance_[r] >= 0 &&
        SameMarkers(models_[recording].recording(), models_[r].recording()))
      return r;
  return std::nullopt;
}

Eigen::MatrixXd CalibrationProblem::InOrderOf(size_t recording, size_t source,
                                              const Eigen::MatrixXd& places) const {
  const auto same = SameMarkers(models_[recording].recording(), models_[source].recording());
  CHECK(same);
  return places(Eigen::all, *same);
}

std::optional<Eigen::MatrixXd> CalibrationProblem::PlacesFromFitted(
    size_t recording, const Eigen::VectorXd& values) const {
  const std::optional<size_t> source = RecordingWithSamePlaces(recording);
  if (!source) return std::nullopt;
  const RecordingModel fitted = ModelAt(*source, values);
  const Misfit misfit =
      fitted.Predict(fitted.recording().FittedFrames(), NuisanceOf(*source, values));
  if (!misfit.summary.IsUsable()) return std::nullopt;
  return InOrderOf(recording, *source,
                   CommonError(misfit.residual, misfit.count, misfit.points, ErrorsOf(fitted),
                               std::vector<char>(misfit.frames.size(), 1), misfit.deformation));
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

ResidualEvaluation CalibrationProblem::PredictRecording(size_t recording,
                                                        const Eigen::VectorXd& values,
                                                        bool with_jacobian, double horizon,
                                                        const PredictionHints& hints,
                                                        Misfit* misfit) const {
  const RecordingModel model = ModelAt(recording, values);
  std::vector<int> frames = model.recording().FittedFrames();
  const double start = model.recording().StartTime();
  std::erase_if(frames, [&](int frame) { return model.FrameTime(frame) > start + horizon; });
  std::vector<MisfitDirection> directions;
  if (with_jacobian) directions = DirectionsFor(model, {});
  *misfit = model.Predict(frames, NuisanceOf(recording, values), directions, hints);
  ResidualEvaluation part;
  if (!misfit->summary.IsUsable())
    part.message = misfit->summary.message;
  else if (hints.reach_factor <= 1)
    part.message = Mismatch(model, *misfit);
  part.usable = part.message.empty();
  if (!part.usable) {
    part.message = model.recording().name + ": " + part.message;
    return part;
  }
  const auto columns = [&](const Eigen::MatrixXd& by) {
    return with_jacobian ? ColumnsOf(recording, by, 0) : Eigen::MatrixXd(by.rows(), 0);
  };
  const auto whitened = [&](const Eigen::MatrixXd& what) {
    return Whitened(what, misfit->count, model.PointCount(), ErrorsOf(model), misfit->deformation);
  };
  AppendWhitened(whitened(misfit->residual), whitened(columns(misfit->jacobian)),
                 model.observer().Components() * model.PointCount(), misfit->count, &part);
  for (size_t k = 0; k < misfit->reactions.size(); ++k) {
    const ReactionMisfit& reaction = misfit->reactions[k];
    const auto whitened_force = [&](const Eigen::MatrixXd& what) {
      return Whitened(what, reaction.count, reaction.components,
                      ReadingErrors(model.Reactions()[k]));
    };
    AppendWhitened(whitened_force(reaction.residual), whitened_force(columns(reaction.jacobian)),
                   reaction.components, reaction.count, &part);
  }
  return part;
}

ResidualEvaluation CalibrationProblem::Predict(const Eigen::VectorXd& values, bool with_jacobian,
                                               double horizon, FitMemory* memory) const {
  ThrowIfInterrupted();
  FitMemory nothing;
  FitMemory& known = memory != nullptr ? *memory : nothing;
  const bool seek = known.correspondences.empty();
  if (seek) known.correspondences.resize(models_.size());
  known.equilibria.resize(models_.size());
  const std::vector<Eigen::VectorXd> equilibria_before = known.equilibria;
  const std::vector<size_t> fitted = FittedRecordings();
  std::vector<ResidualEvaluation> parts(fitted.size());
  ParallelFor(static_cast<int64_t>(fitted.size()), 1, [&](int64_t k) {
    const size_t r = fitted[static_cast<size_t>(k)];
    Misfit misfit;
    parts[static_cast<size_t>(k)] = PredictRecording(
        r, values, with_jacobian, horizon,
        {seek ? nullptr : &known.correspondences[r], &known.equilibria[r], known.reach_factor},
        &misfit);
    if (misfit.summary.held.size() > 0) known.equilibria[r] = misfit.summary.held;
    if (seek) known.correspondences[r] = std::move(misfit.observed);
  });
  ResidualEvaluation all;
  Eigen::Index rows = 0;
  for (const ResidualEvaluation& part : parts) {
    if (!part.usable) {
      // The result of the next prediction must not depend on one that has failed.
      known.equilibria = equilibria_before;
      if (seek) known.correspondences.clear();
      return part;
    }
    rows += part.residual.size();
  }
  all.usable = true;
  all.residual.resize(rows);
  if (with_jacobian) all.jacobian.resize(rows, static_cast<Eigen::Index>(parameters_.size()));
  Eigen::Index row = 0;
  for (const ResidualEvaluation& part : parts) {
    all.residual.segment(row, part.residual.size()) = part.residual;
    if (with_jacobian) all.jacobian.middleRows(row, part.residual.size()) = part.jacobian;
    for (const Eigen::Index before : part.before)
      all.before.push_back(before < 0 ? before : row + before);
    all.unobserved += part.unobserved;
    row += part.residual.size();
  }
  return all;
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
