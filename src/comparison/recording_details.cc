#include "comparison/recording_details.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "experiment/reference_body.h"
#include "prediction/prediction_study.h"
#include "prediction/prediction_study_reader.h"
#include "record/run_directory.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

// Distance, m, of each place from the nearest node that the recording fixes or moves. Empty if it
// has no grip.
Eigen::VectorXd GripDistances(const Recording& recording, const Eigen::Matrix3Xd& places,
                              const TetMesh& mesh) {
  std::vector<Region> regions;
  for (const RecordedSupport& support : recording.object.fixed) regions.push_back(support.region);
  for (const RecordedGrip& grip : recording.object.grips) regions.push_back(grip.region);
  Eigen::VectorXd distances =
      Eigen::VectorXd::Constant(places.cols(), std::numeric_limits<double>::infinity());
  for (const Region& region : regions)
    for (const int node : SelectNodes(region, mesh))
      for (Eigen::Index m = 0; m < distances.size(); ++m)
        distances[m] = std::min(distances[m], (places.col(m) - mesh.nodes.col(node)).norm());
  return regions.empty() ? Eigen::VectorXd() : distances;
}

// Whether the run was made from this recording, as far as its first frame shows.
bool MatchesRun(const ComparedRecording& compared, const RecordedResiduals& residuals,
                const PredictedRecording& item) {
  if (item.name != compared.name || item.frames != residuals.frames) return false;
  if (compared.is_scan || item.ShowsScans()) return compared.is_scan && item.ShowsScans();
  const Eigen::Matrix3Xd& first = item.recording.markers.positions[residuals.frames.front()];
  if (3 * first.cols() != residuals.measured.rows()) return false;
  for (Eigen::Index m = 0; m < first.cols(); ++m)
    for (int axis = 0; axis < 3; ++axis) {
      const double now = first(axis, m), then = residuals.measured(3 * m + axis, 0);
      if (now != then && !(std::isnan(now) && std::isnan(then))) return false;
    }
  return true;
}

}  // namespace

std::vector<char> AddRecordingDetails(const std::filesystem::path& run,
                                      const CalibrationRecord& record, Comparison* comparison) {
  std::vector<char> are_markers(comparison->residuals.size());
  std::string problem;
  try {
    const PredictionStudy study =
        ReadPredictionStudy(Config::Load((run / record.experiment).lexically_normal()));
    const ReferenceBody body = ReadReferenceBody(FinishedStage(run, "mesh"));
    for (size_t r = 0; r < comparison->residuals.size(); ++r) {
      ComparedRecording& compared = comparison->record.recordings[r];
      if (r >= study.recordings.size() ||
          !MatchesRun(compared, comparison->residuals[r], study.recordings[r])) {
        problem = compared.name + " is no longer the recording that was fitted";
        continue;
      }
      const Recording& recording = study.recordings[r].recording;
      if (!compared.is_scan) compared.point_names = recording.markers.names;
      are_markers[r] = !compared.is_scan && !HasTrackedPoints(recording);
      compared.grip_distance = GripDistances(
          recording,
          compared.is_scan ? record.recordings[r].scan->places : recording.markers.places,
          body.mesh);
    }
  } catch (const InputError& error) {
    problem = error.what();
  }
  if (!problem.empty()) {
    comparison->record.notes.push_back(
        "Points are identified by their number, counted from 0, and their distance from the grip "
        "is not known: " +
        problem + ".");
  }
  return are_markers;
}

}  // namespace lacuna
