#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/measurement_errors.h"
#include "calibration/calibration_run.h"
#include "comparison/comparison.h"
#include "comparison/comparison_fields.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "prediction/replayed_motion.h"

namespace lacuna {
namespace {

constexpr int kBins = 10;

// How far a replayed difference may be from the recorded one, in σ: what another order of sums can
// do is far less.
constexpr double kSameMotion = 0.1;
constexpr double kAnyPlace = 1;  // m: a place that nothing is known of

// Whether the motion is the one that the fit left its misfits of: they differ by errors of the
// markers' places alone, that move with the object.
bool IsThatMotion(const ComparedRecording& recording, const ReplayedMotion& motion, double noise) {
  if (motion.predicted.cols() != recording.measured.cols() ||
      motion.predicted.rows() != recording.measured.rows())
    return false;
  const Eigen::MatrixXd shown = motion.predicted - recording.measured - recording.difference;
  const int markers = static_cast<int>(shown.rows() / 3);
  std::vector<int> seen;
  for (Eigen::Index f = 0; f < shown.cols(); ++f)
    for (int m = 0; m < markers; ++m) seen.push_back(shown.col(f).segment<3>(3 * m).allFinite());
  const Eigen::MatrixXd places =
      CommonError(shown.reshaped(), seen, markers, {noise, kAnyPlace},
                  std::vector<char>(static_cast<size_t>(shown.cols()), 1), motion.deformation);
  for (size_t k = 0; k < seen.size(); ++k) {
    const Eigen::Index m = static_cast<Eigen::Index>(k) % markers;
    const Eigen::Vector3d other = shown.reshaped().segment<3>(3 * static_cast<Eigen::Index>(k)) -
                                  motion.deformation[k] * places.col(m);
    if (seen[k] && other.cwiseAbs().maxCoeff() > kSameMotion * noise) return false;
  }
  return true;
}

void AddAgainst(const ReplayedMotion& motion, const ComparedRecording& recording,
                ComparedPart* part) {
  const Eigen::Index first = part->first, count = part->last - part->first + 1;
  const Eigen::VectorXd error =
      RmsOfFrames(PointLengths(recording.difference.middleCols(first, count)));
  const auto against = [&](const std::string& quantity, const Eigen::VectorXd& of_frames) {
    part->against.push_back(
        {quantity, BinnedResiduals(of_frames, error, kBins), RankCorrelation(of_frames, error)});
  };
  against("strain", RmsOfFrames(motion.strain.middleCols(first, count)));
  against("strain_rate_per_s", RmsOfFrames(motion.strain_rate.middleCols(first, count)));
  against("height_m", motion.height.middleCols(first, count).colwise().mean().transpose());
}

}  // namespace

void CompareMotion(const std::filesystem::path& run, Progress* progress, Comparison* comparison) {
  const auto without = [&](const std::string& why) {
    comparison->notes.push_back(
        "Without strain, height, fields and the unexplained force, for which the model must be run "
        "again: " +
        why);
  };
  FittedRun fitted;
  try {
    fitted = OpenRun(run);
  } catch (const InputError& error) {
    return without(error.what());
  }
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  progress->Begin("replay", static_cast<int64_t>(comparison->recordings.size()));
  for (size_t r = 0; r < comparison->recordings.size(); ++r) {
    ThrowIfInterrupted();
    ComparedRecording& recording = comparison->recordings[r];
    const RecordingModel model = problem.ModelAt(r, fitted.values);
    if (model.Markers() == nullptr) {
      without(recording.name + " is a recording of scans");
      continue;
    }
    const ReplayedMotion motion = Replay(model, problem.NuisanceOf(r, fitted.values));
    if (!motion.summary.IsUsable() || !IsThatMotion(recording, motion, comparison->noise)) {
      without(recording.name + (motion.summary.IsUsable()
                                    ? " is not predicted as it was when it was fitted"
                                    : " is not predicted to its end: " + motion.summary.message));
      continue;
    }
    recording.height_by_gravity = motion.up_from_gravity;
    for (ComparedPart& part : recording.parts) AddAgainst(motion, recording, &part);
    recording.force =
        EstimateUnexplainedForce(model, motion, problem.noise(), fitted.study.place_deviation);
    recording.field_frames = WriteComparisonFields(model, recording, motion, comparison->noise,
                                                   run / "comparison" / std::to_string(r));
    progress->Report(static_cast<int64_t>(r) + 1);
  }
  progress->End();
}

}  // namespace lacuna
