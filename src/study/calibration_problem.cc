#include "study/calibration_problem.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/interrupt.h"

namespace lacuna {
namespace {

// Share of the fitted time that is fitted first.
constexpr double kShortHorizon = 0.25;
// Share of the time of a recording that is only predicted, over which its own nuisances are found.
constexpr double kNuisanceHorizon = 0.1;

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

MisfitMeasure Measure(const RecordingMisfit& recording, int markers, bool fitted, double noise) {
  MisfitMeasure measure;
  double squares = 0;
  for (size_t f = 0; f < recording.fitted.size(); ++f) {
    if (static_cast<bool>(recording.fitted[f]) != fitted) continue;
    ++measure.frames;
    for (int m = 0; m < markers; ++m) {
      const Eigen::Index at = static_cast<Eigen::Index>(f) * markers + m;
      if (!recording.misfit.observed[at]) continue;
      const double distance =
          (recording.misfit.residual.segment<3>(3 * at) - recording.place_offset.col(m)).norm();
      squares += distance * distance;
      measure.largest = std::max(measure.largest, distance);
      ++measure.points;
    }
  }
  if (measure.points == 0) return measure;
  measure.rms = std::sqrt(squares / measure.points);
  measure.in_noise = measure.rms / (std::sqrt(3.0) * noise);
  return measure;
}

}  // namespace

CalibrationProblem::CalibrationProblem(const PredictionStudy& study, const TetMesh& mesh)
    : study_(study),
      body_(std::make_shared<const Body>(MakeBody(mesh, study.density))),
      noise_(study.noise) {
  for (const ModelParameter& parameter : study.fitted) parameters_.push_back(parameter.prior);
  std::vector<double> noises;
  for (const PredictedRecording& item : study.recordings) {
    models_.emplace_back(study, item, mesh, body_);
    first_nuisance_.push_back(item.fitted ? static_cast<Eigen::Index>(parameters_.size()) : -1);
    if (item.fitted)
      for (const auto& nuisance : models_.back().nuisances()) parameters_.push_back(nuisance.prior);
    noises.push_back(EstimateMarkerNoise(item, models_.back().FittedFrames()));
  }
  for (CalibratedParameter& parameter : parameters_)
    if (std::isnan(parameter.prior_mean)) parameter.prior_mean = parameter.start;
  if (noise_ == 0) noise_ = *std::max_element(noises.begin(), noises.end());
  if (!(noise_ > 0)) {
    throw InputError(
        fmt::format("{}: noise: cannot be estimated (the markers do not move at all); give it",
                    study.file.string()));
  }
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
  const PredictedRecording& item = model.item();
  std::vector<CalibratedParameter> own;
  std::vector<MisfitDirection> directions;
  for (const auto& entry : model.nuisances()) {
    own.push_back(entry.prior);
    directions.push_back(entry.direction);
  }
  const std::vector<double>& times = item.recording.times;
  const double start = item.StartTime();
  const double until = start + kNuisanceHorizon * (times[item.frames.back()] - start);
  std::vector<int> beginning = item.frames;
  std::erase_if(beginning, [&](int frame) { return times[frame] > until; });
  const Calibration fitted = Calibrate(own, [&](const Eigen::VectorXd& at, bool with_jacobian) {
    const Misfit misfit =
        model.Predict(beginning, at, with_jacobian ? directions : std::vector<MisfitDirection>{});
    Prediction prediction{misfit.summary.IsUsable(), misfit.summary.message, {}, {}};
    if (!prediction.usable) return prediction;
    prediction.residual = Whitened(misfit.residual, misfit.observed, model.MarkerCount(), noise_,
                                   study_.place_deviation);
    if (with_jacobian)
      prediction.jacobian =
          Whitened(misfit.by, misfit.observed, model.MarkerCount(), noise_, study_.place_deviation);
    return prediction;
  });
  return fitted.parameters;
}

Prediction CalibrationProblem::Predict(const Eigen::VectorXd& values, bool with_jacobian,
                                       double horizon,
                                       const std::vector<MisfitDirection>& more) const {
  ThrowIfInterrupted();
  SetModel(values);
  Prediction all;
  all.usable = true;
  const Eigen::Index shared = static_cast<Eigen::Index>(study_.fitted.size());
  const Eigen::Index extra = static_cast<Eigen::Index>(more.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(parameters_.size()) + extra;
  std::vector<Eigen::VectorXd> residuals;
  std::vector<Eigen::MatrixXd> jacobians;
  Eigen::Index rows = 0;
  for (size_t r = 0; r < models_.size(); ++r) {
    const RecordingModel& model = models_[r];
    if (first_nuisance_[r] < 0) continue;
    std::vector<int> frames = model.FittedFrames();
    const std::vector<double>& times = model.item().recording.times;
    const double start = model.item().StartTime();
    std::erase_if(frames, [&](int frame) { return times[frame] > start + horizon; });
    std::vector<MisfitDirection> directions;
    if (with_jacobian) {
      directions = DirectionsOf(study_.fitted);
      directions.insert(directions.end(), more.begin(), more.end());
      for (const auto& nuisance : model.nuisances()) directions.push_back(nuisance.direction);
    }
    const Misfit misfit = model.Predict(frames, NuisanceOf(r, values), directions);
    if (!misfit.summary.IsUsable()) {
      all.usable = false;
      all.message = model.item().name + ": " + misfit.summary.message;
      return all;
    }
    const auto whitened = [&](const Eigen::MatrixXd& what) {
      return Whitened(what, misfit.observed, model.MarkerCount(), noise_, study_.place_deviation);
    };
    residuals.emplace_back(whitened(misfit.residual));
    rows += misfit.residual.size();
    if (!with_jacobian) continue;
    const Eigen::Index own = static_cast<Eigen::Index>(model.nuisances().size());
    const Eigen::Index places = misfit.by.cols() - extra - own;
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(misfit.residual.size(), columns);
    jacobian.leftCols(shared) = SumOverPlaces(study_.fitted, misfit.by.leftCols(places));
    jacobian.rightCols(extra) = misfit.by.middleCols(places, extra);
    jacobian.middleCols(first_nuisance_[r], own) = misfit.by.rightCols(own);
    jacobians.push_back(whitened(jacobian));
  }
  all.residual.resize(rows);
  if (with_jacobian) all.jacobian.resize(rows, columns);
  Eigen::Index row = 0;
  for (size_t k = 0; k < residuals.size(); ++k) {
    all.residual.segment(row, residuals[k].size()) = residuals[k];
    if (with_jacobian) all.jacobian.middleRows(row, jacobians[k].rows()) = jacobians[k];
    row += residuals[k].size();
  }
  return all;
}

LinearisedMisfit CalibrationProblem::Linearise(
    const Eigen::VectorXd& values, bool with_jacobian,
    const std::vector<MisfitDirection>& directions) const {
  ThrowIfInterrupted();
  SetModel(values);
  LinearisedMisfit all;
  const Eigen::Index shared = static_cast<Eigen::Index>(study_.fitted.size());
  const Eigen::Index extra = static_cast<Eigen::Index>(directions.size());
  const Eigen::Index columns = static_cast<Eigen::Index>(parameters_.size()) + extra;
  for (size_t r = 0; r < models_.size(); ++r) {
    const RecordingModel& model = models_[r];
    const PredictedRecording& item = model.item();
    if (first_nuisance_[r] < 0) continue;
    // The clock comes last: its derivative is the speed, with the sign turned.
    std::vector<MisfitDirection> wanted;
    if (with_jacobian) {
      wanted = DirectionsOf(study_.fitted);
      wanted.insert(wanted.end(), directions.begin(), directions.end());
      for (const auto& nuisance : model.nuisances()) wanted.push_back(nuisance.direction);
    }
    wanted.push_back({.perturbation = {}, .is_clock = true});
    const Misfit misfit = model.Predict(item.frames, NuisanceOf(r, values), wanted);
    if (!misfit.summary.IsUsable()) {
      all.message = item.name + ": " + misfit.summary.message;
      return all;
    }
    LinearisedMisfit::Part part;
    part.recording = r;
    part.first_row = all.residual.size();
    part.layout.series = 3 * model.MarkerCount();
    for (const int frame : misfit.frames) {
      part.layout.times.push_back(item.recording.times[frame]);
      part.fitted.push_back(item.recording.times[frame] <= item.fit_until);
    }
    for (const char observed : misfit.observed)
      part.layout.observed.insert(part.layout.observed.end(), 3, observed);
    part.speed = -misfit.by.rightCols<1>();
    const Eigen::Index rows = misfit.residual.size();
    all.residual.conservativeResize(part.first_row + rows);
    all.residual.tail(rows) = misfit.residual;
    if (with_jacobian) {
      all.by.conservativeResizeLike(Eigen::MatrixXd::Zero(part.first_row + rows, columns));
      const Eigen::Index own = static_cast<Eigen::Index>(model.nuisances().size());
      const Eigen::Index places = misfit.by.cols() - 1 - extra - own;
      auto by = all.by.bottomRows(rows);
      by.leftCols(shared) = SumOverPlaces(study_.fitted, misfit.by.leftCols(places));
      by.rightCols(extra) = misfit.by.middleCols(places, extra);
      by.middleCols(first_nuisance_[r], own) = misfit.by.middleCols(places + extra, own);
    }
    all.parts.push_back(std::move(part));
  }
  all.usable = true;
  return all;
}

Calibration CalibrationProblem::Fit(const Eigen::VectorXd& start, Progress* progress,
                                    const CalibrationOptions& options) const {
  double longest = 0;
  for (const RecordingModel& model : models_) {
    const std::vector<int> frames = model.FittedFrames();
    const std::vector<double>& times = model.item().recording.times;
    if (frames.empty()) continue;
    longest = std::max(longest, times[frames.back()] - model.item().StartTime());
  }
  Calibration calibration;
  std::vector<CalibratedParameter> parameters = parameters_;
  Eigen::VectorXd values = start;
  int evaluations = 0;
  for (const double share : {kShortHorizon, 1.0}) {
    for (size_t k = 0; k < parameters.size(); ++k)
      parameters[k].start =
          std::clamp(values[static_cast<Eigen::Index>(k)], parameters[k].min, parameters[k].max);
    progress->Begin(share < 1 ? "fit, first part" : "fit", 0);
    const double horizon = share < 1 ? share * longest : std::numeric_limits<double>::infinity();
    calibration = Calibrate(
        parameters,
        [&](const Eigen::VectorXd& at, bool with_jacobian) {
          const Prediction prediction = Predict(at, with_jacobian, horizon);
          progress->Report(++evaluations,
                           prediction.usable ? RootMeanSquare(prediction.residual) : std::nan(""));
          return prediction;
        },
        options);
    progress->End(calibration.usable ? "" : calibration.message);
    if (calibration.parameters.size() > 0) values = calibration.parameters;
  }
  calibration.predictions = evaluations;
  // "Before" is where the caller started, not where the first part ended.
  const Prediction before = Predict(start, /*with_jacobian=*/false);
  calibration.start_rms =
      before.usable ? RootMeanSquare(before.residual) : std::numeric_limits<double>::infinity();
  SetModel(values);
  return calibration;
}

std::vector<RecordingMisfit> CalibrationProblem::Misfits(const Eigen::VectorXd& values) const {
  SetModel(values);
  std::vector<RecordingMisfit> all;
  for (size_t r = 0; r < models_.size(); ++r) {
    const RecordingModel& model = models_[r];
    const PredictedRecording& item = model.item();
    const int markers = model.MarkerCount();
    RecordingMisfit recording;
    recording.name = item.name;
    recording.misfit = model.Predict(item.frames, NuisanceOf(r, values), {});
    const double release = item.StartTime();
    recording.place_offset.setZero(3, markers);
    Eigen::VectorXd seen = Eigen::VectorXd::Zero(markers);
    for (size_t f = 0; f < recording.misfit.frames.size(); ++f) {
      const double time = item.recording.times[recording.misfit.frames[f]];
      const bool fitted = item.fitted && time <= item.fit_until;
      recording.fitted.push_back(fitted);
      // Of a recording that is not fitted, only what it shows before it moves tells the places.
      if (!fitted && (item.fitted || time > release)) continue;
      for (int m = 0; m < markers; ++m) {
        const Eigen::Index at = static_cast<Eigen::Index>(f) * markers + m;
        if (!recording.misfit.observed[at]) continue;
        recording.place_offset.col(m) += recording.misfit.residual.segment<3>(3 * at);
        seen[m] += 1;
      }
    }
    const double ratio = study_.place_deviation / noise_;
    for (int m = 0; m < markers; ++m)
      recording.place_offset.col(m) *= ratio * ratio / (1 + seen[m] * ratio * ratio);
    recording.in_fit = Measure(recording, markers, true, noise_);
    recording.held_out = Measure(recording, markers, false, noise_);
    all.push_back(std::move(recording));
  }
  return all;
}

}  // namespace lacuna
