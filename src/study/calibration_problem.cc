#include "study/calibration_problem.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/interrupt.h"
#include "study/own_nuisance.h"

namespace lacuna {
namespace {

// Share of the fitted time that is fitted first.
constexpr double kShortHorizon = 0.25;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();
// A fit that may be astray is tried from these parts of the moduli's start values.
constexpr double kOtherStarts[] = {0.5, 2, 0.25, 4};
// Of a fit to scans: correspondences are taken anew after so many iterations, as an exact fit to
// wrong ones is worth nothing, and have settled when no parameter moves by more than this part of
// its posterior deviation.
constexpr int kIterationsOfRound = 12;
constexpr double kSettled = 0.1;
// Correspondences mean nothing where fewer of a frame's points have one, in parts of the best's.
constexpr double kFewestMatched = 0.5;

std::vector<MisfitDirection> DirectionsOf(const std::vector<ModelParameter>& parameters) {
  std::vector<MisfitDirection> directions;
  for (const ModelParameter& parameter : parameters)
    for (const auto& [effect, index] : parameter.places)
      directions.push_back({{.effect = effect, .parameter = index}});
  return directions;
}

// Columns of one parameter's places added up.
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

// Why the correspondences of a scan mean nothing; empty: they do.
std::string Mismatch(const RecordingModel& model, const Misfit& misfit) {
  const size_t lost = model.LostFrames(misfit, kFewestMatched).size();
  if (2 * lost <= misfit.frames.size()) return "";
  return fmt::format(
      "in {} of {} frames most scanned points are farther than scan.reach from the predicted "
      "surface: start nearer to the solution, or enlarge the reach",
      lost, misfit.frames.size());
}

// Of any parameter, in parts of its posterior deviation.
double LargestChange(const std::vector<CalibratedParameter>& parameters,
                     const Calibration& calibration, const Eigen::VectorXd& from) {
  double largest = 0;
  for (size_t k = 0; k < parameters.size(); ++k)
    largest = std::max(
        largest, std::abs(DeviationsTo(from[static_cast<Eigen::Index>(k)], calibration.estimates[k],
                                       parameters[k].log_scale)));
  return largest;
}

}  // namespace

CalibrationProblem::CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh)
    : study_(study),
      body_(std::make_shared<const Body>(MakeBody(mesh, study.density))),
      patches_(study.patches),
      noise_(study.noise) {
  for (const ModelParameter& parameter : study.fitted) parameters_.push_back(parameter.prior);
  const bool has_scans =
      std::any_of(study.recordings.begin(), study.recordings.end(),
                  [](const PredictedRecording& item) { return item.scans != nullptr; });
  if (has_scans && patches_.Count() == 0)
    patches_ = DivideSurface(body_->boundary.surface, study.scan.patches);
  double of_markers = 0, of_scans = 0;
  bool has_markers = false;
  for (const PredictedRecording& item : study.recordings) {
    models_.emplace_back(study, item, mesh, body_, patches_);
    first_nuisance_.push_back(item.fitted ? static_cast<Eigen::Index>(parameters_.size()) : -1);
    if (item.fitted)
      for (const auto& nuisance : models_.back().nuisances()) parameters_.push_back(nuisance.prior);
    has_markers = has_markers || item.scans == nullptr;
    double& largest = item.scans != nullptr ? of_scans : of_markers;
    largest = std::max(largest, EstimateRecordingNoise(item, models_.back().FittedFrames()));
  }
  for (CalibratedParameter& parameter : parameters_)
    if (std::isnan(parameter.prior_mean)) parameter.prior_mean = parameter.start;
  if (noise_ == 0 || !has_markers) noise_ = of_markers;
  if (has_markers && !(noise_ > 0)) {
    throw InputError(
        fmt::format("{}: noise: cannot be estimated (the markers do not move at all); give it",
                    study.file.string()));
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
  return model.item().scans != nullptr ? MeasurementErrors{scan_noise_, study_.scan.shape_deviation}
                                       : MeasurementErrors{noise_, study_.place_deviation};
}

PredictionStudy CalibrationProblem::WithGivenNoise() const {
  PredictionStudy given = study_;
  given.noise = noise_;
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

void CalibrationProblem::SetModel(const Eigen::VectorXd& values) const {
  for (size_t k = 0; k < study_.fitted.size(); ++k)
    SetParameter(study_.fitted[k], values[static_cast<Eigen::Index>(k)]);
}

Eigen::VectorXd CalibrationProblem::NuisanceOf(size_t recording,
                                               const Eigen::VectorXd& values) const {
  const RecordingModel& model = models_[recording];
  if (first_nuisance_[recording] >= 0)
    return values.segment(first_nuisance_[recording],
                          static_cast<Eigen::Index>(model.nuisances().size()));
  return OwnNuisance(model, ErrorsOf(model));
}

Prediction CalibrationProblem::Predict(const Eigen::VectorXd& values, bool with_jacobian,
                                       double horizon) const {
  Correspondences found;
  return PredictWith(values, with_jacobian, horizon, &found);
}

std::vector<MisfitDirection> CalibrationProblem::DirectionsFor(
    size_t recording, const std::vector<MisfitDirection>& further) const {
  std::vector<MisfitDirection> directions = DirectionsOf(study_.fitted);
  directions.insert(directions.end(), further.begin(), further.end());
  for (const auto& nuisance : models_[recording].nuisances())
    directions.push_back(nuisance.direction);
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

Prediction CalibrationProblem::PredictWith(const Eigen::VectorXd& values, bool with_jacobian,
                                           double horizon, Correspondences* correspondences) const {
  ThrowIfInterrupted();
  SetModel(values);
  Prediction all;
  all.usable = true;
  std::vector<Eigen::VectorXd> residuals;
  std::vector<Eigen::MatrixXd> jacobians;
  Eigen::Index rows = 0;
  const bool seek = correspondences->empty();
  if (seek) correspondences->resize(models_.size());
  for (size_t r = 0; r < models_.size(); ++r) {
    const RecordingModel& model = models_[r];
    if (first_nuisance_[r] < 0) continue;
    std::vector<int> frames = model.FittedFrames();
    const std::vector<double>& times = model.item().recording.times;
    const double start = model.item().StartTime();
    std::erase_if(frames, [&](int frame) { return times[frame] > start + horizon; });
    std::vector<MisfitDirection> directions;
    if (with_jacobian) directions = DirectionsFor(r, {});
    Misfit misfit = model.Predict(frames, NuisanceOf(r, values), directions,
                                  seek ? nullptr : &(*correspondences)[r]);
    all.message = misfit.summary.IsUsable() ? Mismatch(model, misfit) : misfit.summary.message;
    if (!all.message.empty()) {
      all.usable = false;
      all.message = model.item().name + ": " + all.message;
      return all;
    }
    if (seek) (*correspondences)[r] = std::move(misfit.observed);
    const auto whitened = [&](const Eigen::MatrixXd& what) {
      return Whitened(what, misfit.count, model.PointCount(), ErrorsOf(model), misfit.deformation);
    };
    residuals.emplace_back(whitened(misfit.residual));
    rows += misfit.residual.size();
    if (with_jacobian) jacobians.push_back(whitened(ColumnsOf(r, misfit.by, 0)));
  }
  all.residual.resize(rows);
  if (with_jacobian) all.jacobian.resize(rows, static_cast<Eigen::Index>(parameters_.size()));
  Eigen::Index row = 0;
  for (size_t k = 0; k < residuals.size(); ++k) {
    all.residual.segment(row, residuals[k].size()) = residuals[k];
    if (with_jacobian) all.jacobian.middleRows(row, jacobians[k].rows()) = jacobians[k];
    row += residuals[k].size();
  }
  return all;
}

LinearisedMisfit CalibrationProblem::Linearise(const Eigen::VectorXd& values, bool with_jacobian,
                                               const std::vector<MisfitDirection>& directions,
                                               const LinearisedMisfit* same) const {
  ThrowIfInterrupted();
  SetModel(values);
  LinearisedMisfit all;
  const Eigen::Index extra = static_cast<Eigen::Index>(directions.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(parameters_.size()) + extra;
  for (size_t r = 0; r < models_.size(); ++r) {
    const RecordingModel& model = models_[r];
    const PredictedRecording& item = model.item();
    if (first_nuisance_[r] < 0) continue;
    // The clock comes last: its derivative is the speed, with the sign turned.
    std::vector<MisfitDirection> wanted;
    if (with_jacobian) wanted = DirectionsFor(r, directions);
    wanted.push_back({.perturbation = {}, .is_clock = true});
    Misfit misfit =
        model.Predict(item.frames, NuisanceOf(r, values), wanted,
                      same != nullptr ? &same->parts[all.parts.size()].observed : nullptr);
    if (!misfit.summary.IsUsable()) {
      all.message = item.name + ": " + misfit.summary.message;
      return all;
    }
    LinearisedMisfit::Part part;
    part.recording = r;
    part.first_row = all.residual.size();
    part.errors = ErrorsOf(model);
    const Eigen::Index components = model.observer().Components();
    part.layout.series = static_cast<int>(components) * model.PointCount();
    for (const int frame : misfit.frames) {
      part.layout.times.push_back(item.recording.times[frame]);
      part.fitted.push_back(item.recording.times[frame] <= item.fit_until);
    }
    for (const int count : misfit.count)
      part.layout.count.insert(part.layout.count.end(), static_cast<size_t>(components), count);
    part.layout.deformation = std::move(misfit.deformation);
    part.observed = std::move(misfit.observed);
    part.speed = -misfit.by.rightCols<1>();
    const Eigen::Index rows = misfit.residual.size();
    all.residual.conservativeResize(part.first_row + rows);
    all.residual.tail(rows) = misfit.residual;
    if (with_jacobian) {
      all.by.conservativeResizeLike(Eigen::MatrixXd::Zero(part.first_row + rows, columns));
      all.by.bottomRows(rows) = ColumnsOf(r, misfit.by.leftCols(misfit.by.cols() - 1), extra);
    }
    all.parts.push_back(std::move(part));
  }
  all.usable = true;
  return all;
}

Calibration CalibrationProblem::FitOver(double horizon, const Eigen::VectorXd& start,
                                        const CalibrationOptions& options, Progress* progress,
                                        int* evaluations) const {
  Calibration calibration;
  std::vector<CalibratedParameter> parameters = parameters_;
  Eigen::VectorXd values = start;
  CalibrationOptions of_round = options;
  for (int iterations = 0; iterations < options.max_iterations;) {
    if (HasScans())
      of_round.max_iterations = std::min(kIterationsOfRound, options.max_iterations - iterations);
    for (size_t k = 0; k < parameters.size(); ++k)
      parameters[k].start =
          std::clamp(values[static_cast<Eigen::Index>(k)], parameters[k].min, parameters[k].max);
    Correspondences correspondences;
    calibration = Calibrate(
        parameters,
        [&](const Eigen::VectorXd& at, bool with_jacobian) {
          const Prediction prediction = PredictWith(at, with_jacobian, horizon, &correspondences);
          progress->Report(++*evaluations,
                           prediction.usable ? RootMeanSquare(prediction.residual) : std::nan(""));
          return prediction;
        },
        of_round);
    if (!HasScans() || calibration.estimates.empty()) return calibration;
    const double moved = LargestChange(parameters_, calibration, values);
    values = calibration.parameters;
    if (moved < kSettled) {
      // A round need not have converged to the last digit when all of it changed so little.
      calibration.usable = true;
      calibration.message.clear();
      return calibration;
    }
    iterations += std::max(calibration.iterations, 1);
  }
  calibration.usable = false;
  calibration.message =
      "scanned points and places of the surface did not settle: start nearer to the solution, fit "
      "less at once, or give scan.reach a smaller value";
  return calibration;
}

double CalibrationProblem::LongestFitted() const {
  double longest = 0;
  for (const RecordingModel& model : models_) {
    const std::vector<int> frames = model.FittedFrames();
    const std::vector<double>& times = model.item().recording.times;
    if (frames.empty()) continue;
    longest = std::max(longest, times[frames.back()] - model.item().StartTime());
  }
  return longest;
}

Calibration CalibrationProblem::FitStage(const std::string& name, double horizon,
                                         const Eigen::VectorXd& start,
                                         const CalibrationOptions& options, Progress* progress,
                                         int* evaluations) const {
  progress->Begin(name, 0);
  Calibration calibration = FitOver(horizon, start, options, progress, evaluations);
  progress->Report(*evaluations, calibration.rms);  // not of the last values tried
  progress->End(calibration.message);
  calibration.predictions = *evaluations;
  return calibration;
}

Calibration CalibrationProblem::FitBeginning(const Eigen::VectorXd& start,
                                             Progress* progress) const {
  int evaluations = 0;
  const Calibration calibration = FitStage("fit, first part", kShortHorizon * LongestFitted(),
                                           start, {}, progress, &evaluations);
  if (calibration.parameters.size() > 0) SetModel(calibration.parameters);
  return calibration;
}

Calibration CalibrationProblem::FitWhole(const Eigen::VectorXd& start, const Calibration& beginning,
                                         Progress* progress) const {
  int evaluations = beginning.predictions;
  const Eigen::VectorXd& near = beginning.parameters.size() > 0 ? beginning.parameters : start;
  Calibration calibration =
      FitStage("fit", kUnlimited, near, {.near_rms = kMayBeAstray}, progress, &evaluations);
  // "Before" is where the caller started, not where the first part ended.
  const Prediction before = Predict(start, /*with_jacobian=*/false);
  calibration.start_rms = before.usable ? RootMeanSquare(before.residual) : kUnlimited;
  SetModel(calibration.parameters.size() > 0 ? calibration.parameters : near);
  return calibration;
}

Calibration CalibrationProblem::Fit(const Eigen::VectorXd& start, Progress* progress) const {
  return FitWhole(start, FitBeginning(start, progress), progress);
}

Calibration CalibrationProblem::FitOn(const Eigen::VectorXd& start, Progress* progress) const {
  int evaluations = 0;
  const Calibration calibration =
      FitStage("fit", kUnlimited, start, {.near_rms = kUnlimited}, progress, &evaluations);
  if (calibration.parameters.size() > 0) SetModel(calibration.parameters);
  return calibration;
}

Calibration CalibrationProblem::FitFromStart(Progress* progress,
                                             const Calibration* beginning) const {
  Calibration calibration =
      beginning != nullptr ? FitWhole(Start(), *beginning, progress) : Fit(Start(), progress);
  if (calibration.usable && calibration.rms <= kMayBeAstray) return calibration;
  const auto is_modulus = [&](size_t k) {
    return parameters_[k].log_scale && study_.fitted[k].unit == "Pa";
  };
  int evaluations = calibration.predictions;
  double least = calibration.usable ? calibration.rms : kUnlimited;
  Eigen::VectorXd nearest;
  for (const double factor : kOtherStarts) {
    Eigen::VectorXd start = Start();
    for (size_t k = 0; k < study_.fitted.size(); ++k)
      if (is_modulus(k)) start[static_cast<Eigen::Index>(k)] *= factor;
    if (start == Start()) return calibration;
    const Calibration first =
        FitStage(fmt::format("fit, moduli from {:g} of their start", factor),
                 kShortHorizon * LongestFitted(), start, {}, progress, &evaluations);
    const Prediction whole =
        first.estimates.empty() ? Prediction{} : Predict(first.parameters, false);
    const double left = whole.usable ? RootMeanSquare(whole.residual) : kUnlimited;
    if (left >= least) continue;
    least = left;
    nearest = first.parameters;
  }
  if (nearest.size() > 0) {
    Calibration other = Fit(nearest, progress);
    if (other.usable && (!calibration.usable || other.rms < calibration.rms)) {
      evaluations += other.predictions;
      other.start_rms = calibration.start_rms;
      calibration = std::move(other);
    }
  }
  calibration.predictions = evaluations;
  if (calibration.parameters.size() > 0) SetModel(calibration.parameters);
  return calibration;
}

}  // namespace lacuna
