#include "comparison/compared_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/measurement_errors.h"
#include "analysis/residual_statistics.h"
#include "calibration/calibration_run.h"
#include "calibration/held_out_misfit.h"
#include "comparison/comparison_fields.h"
#include "comparison/force_estimate.h"
#include "comparison/part_comparison.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "fem/nodal_recovery.h"
#include "prediction/predicted_states.h"
#include "prediction/replayed_motion.h"

namespace lacuna {
namespace {

// A replayed residual may deviate from the recorded one by at most this many σ. Rounding in another
// order of summation causes far smaller deviations, another model causes larger ones.
constexpr double kSameMotion = 0.1;
constexpr double kAnyPlace = 1;  // m, so wide a prior leaves the places of the markers undetermined
// At most this share of the patches may deviate by more: rounding can move single scanned points
// into a neighbouring patch. Larger: small changes of the model remain unnoticed.
constexpr double kOtherMatches = 0.01;

// Whether the motion is the one that was fitted. It then differs from the recorded residuals only
// by errors of the markers' places, which move with the object and which the fit has subtracted.
bool MatchesFittedMarkers(const RecordedResiduals& residuals, const ReplayedMotion& motion,
                          double noise) {
  if (motion.predicted.cols() != residuals.measured.cols() ||
      motion.predicted.rows() != residuals.measured.rows())
    return false;
  const Eigen::MatrixXd shown = motion.predicted - residuals.measured - residuals.difference;
  const int markers = residuals.PointCount();
  std::vector<double> seen;
  for (Eigen::Index f = 0; f < shown.cols(); ++f)
    for (int m = 0; m < markers; ++m) seen.push_back(shown.col(f).segment<3>(3 * m).allFinite());
  const Eigen::MatrixXd places = CommonError(
      shown.reshaped(), seen, markers, {noise, kAnyPlace},
      std::vector<char>(static_cast<size_t>(shown.cols()), 1), motion.misfit.deformation);
  for (size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Index m = static_cast<Eigen::Index>(k) % markers;
    const Eigen::Vector3d other = shown.reshaped().segment<3>(3 * static_cast<Eigen::Index>(k)) -
                                  motion.misfit.deformation[k] * places.col(m);
    if (seen[k] && other.cwiseAbs().maxCoeff() > kSameMotion * noise) return false;
  }
  return true;
}

// Whether the motion is the one that was fitted to scans: the residuals along the normals are the
// recorded ones, without the errors of the patches that the fit has subtracted. `errors`: as in the
// fit.
bool MatchesFittedPatches(const RecordedResiduals& residuals, const ReplayedMotion& motion,
                          const PredictedRecording& item, const MeasurementErrors& errors) {
  const Eigen::MatrixXd& recorded = residuals.along_normal;
  const Misfit& misfit = motion.misfit;
  if (misfit.points != recorded.rows() || std::ssize(misfit.frames) != recorded.cols())
    return false;
  const Eigen::VectorXd replayed = misfit.ResidualWithout(CommonError(
      misfit.residual, misfit.count, misfit.points, errors, TellsPlaces(item, misfit.frames)));
  Eigen::Index in_any = 0, other = 0;
  for (Eigen::Index k = 0; k < recorded.size(); ++k) {
    const bool in_fit = !std::isnan(recorded.reshaped()[k]);
    const bool now = misfit.count[static_cast<size_t>(k)] > 0;
    in_any += in_fit || now;
    if (in_fit && now) {
      const double difference = std::abs(replayed[k] - recorded.reshaped()[k]);
      other += difference > kSameMotion * residuals.sigma.reshaped()[k];
    } else {
      other += in_fit != now;
    }
  }
  return static_cast<double>(other) <= kOtherMatches * static_cast<double>(in_any);
}

// `over_noise`: LengthsOverNoise() of the whole recording.
void AddMotionTrends(const ReplayedMotion& motion, const RecordedResiduals& residuals,
                     const Eigen::MatrixXd& over_noise, const FrameRange& range,
                     ComparedPart* part) {
  const auto in_range = [&](const Eigen::MatrixXd& all) -> Eigen::MatrixXd {
    return all.middleCols(range.first, range.Count());
  };
  const Eigen::VectorXd error = RmsOfFrames(PointLengths(in_range(residuals.difference)));
  const Eigen::VectorXd multiple = RmsOfFrames(in_range(over_noise));
  const auto add_trend = [&](const char* quantity, const Eigen::VectorXd& values) {
    part->trends.push_back(TrendWith(quantity, values, error, multiple));
  };
  add_trend("strain", RmsOfFrames(in_range(motion.strain)));
  add_trend("strain_rate_per_s", RmsOfFrames(in_range(motion.strain_rate)));
  add_trend("height_m", in_range(motion.height).colwise().mean().transpose());
}

LoadedMost FindLoadedMost(const Model& model, const ReplayedMotion& motion) {
  LoadedMost loaded;
  for (const TrajectoryState& state : motion.states) {
    const NodalStress stress =
        RecoverNodalStress(model, state.position, state.velocity, state.time, state.effect_state);
    const auto keep_largest = [&](const Eigen::VectorXd& nodal, double* value, double* time,
                                  Eigen::Vector3d* place) {
      Eigen::Index node = 0;
      const double largest = nodal.maxCoeff(&node);
      if (largest <= *value) return;  // false where *value is not known yet
      *value = largest;
      *time = state.time + motion.delay;
      *place = model.body->mesh.nodes.col(node);
    };
    keep_largest(stress.von_mises, &loaded.von_mises, &loaded.von_mises_time,
                 &loaded.von_mises_place);
    keep_largest(stress.stretch.row(0).transpose(), &loaded.stretch, &loaded.stretch_time,
                 &loaded.stretch_place);
  }
  return loaded;
}

// Keeps the motion for the report, with the unexplained force where it could be computed.
void KeepMotionWithForce(const RecordingModel& model, const Eigen::VectorXd& nuisance,
                         const UnexplainedForce& force, const std::string& fit,
                         const std::filesystem::path& file) {
  MotionRecord motion = ShownMotion(model, PredictStates(model, nuisance),
                                    force.record.usable ? &force.field : nullptr);
  motion.fit = fit;
  MakeFolder(file.parent_path());
  WriteMotionFile(motion, file);
}

}  // namespace

std::optional<std::string> NoteOnScale(const std::vector<FittedParameter>& parameters) {
  for (const FittedParameter& parameter : parameters) {
    const Determination determination = parameter.estimate.determination;
    if (parameter.unit != "Pa" ||
        (determination != Determination::kFlat && determination != Determination::kDead))
      continue;
    return fmt::format(
        "These recordings do not determine {}, whose value is one of many: stresses and forces of "
        "the model, and the unexplained force, are known up to a common factor only.",
        parameter.name);
  }
  return std::nullopt;
}

void CompareMotion(const std::filesystem::path& run, Progress* progress, Comparison* comparison) {
  const auto note_omission = [&](const std::string& why) {
    comparison->record.notes.push_back(
        "Strain, height, fields and the unexplained force are left out, because they need the "
        "model to be run again: " +
        why + ".");
  };
  FittedRun fitted;
  try {
    fitted = OpenRun(run);
  } catch (const InputError& error) {
    return note_omission(error.what());
  }
  if (const auto note = NoteOnScale(fitted.record.parameters))
    comparison->record.notes.push_back(*note);
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  progress->Begin("replay", static_cast<int64_t>(comparison->residuals.size()));
  for (size_t r = 0; r < comparison->residuals.size(); ++r) {
    ThrowIfInterrupted();
    ComparedRecording& recording = comparison->record.recordings[r];
    const RecordedResiduals& residuals = comparison->residuals[r];
    const RecordingModel model = problem.ModelAt(r, fitted.values);
    const Eigen::VectorXd nuisance = problem.NuisanceOf(r, fitted.values);
    const ReplayedMotion motion = Replay(model, nuisance);
    if (!motion.summary.IsUsable()) {
      note_omission("the prediction of " + recording.name +
                    " stops before its end: " + motion.summary.message);
      continue;
    }
    const MeasurementErrors errors = problem.ErrorsOf(model);
    const bool matches = recording.is_scan
                             ? MatchesFittedPatches(residuals, motion, model.recording(), errors)
                             : MatchesFittedMarkers(residuals, motion, comparison->record.noise);
    if (!matches) {
      note_omission("the model no longer predicts " + recording.name + " as it did in the fit");
      continue;
    }
    recording.height_by_gravity = motion.up_from_gravity;
    const Eigen::MatrixXd over_noise = LengthsOverNoise(residuals, recording);
    const std::vector<FrameRange> ranges = FittedAndHeldOutRanges(residuals);
    for (size_t p = 0; p < ranges.size(); ++p)
      AddMotionTrends(motion, residuals, over_noise, ranges[p], &recording.parts[p]);
    recording.loaded_most = FindLoadedMost(model.model(), motion);
    comparison->forces[r] = EstimateUnexplainedForce(model, motion, errors);
    recording.force = comparison->forces[r]->record;
    recording.field_frames =
        WriteComparisonFields(model, residuals, motion, *comparison->forces[r], over_noise,
                              run / "comparison" / std::to_string(r));
    KeepMotionWithForce(model, nuisance, *comparison->forces[r], comparison->record.fit,
                        MotionFile(run, r));
    progress->Report(static_cast<int64_t>(r) + 1);
  }
  progress->End();
}

}  // namespace lacuna
