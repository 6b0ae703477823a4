#include "calibration/prior_conflicts.h"

#include <algorithm>
#include <cmath>

#include "analysis/whiteness.h"
#include "fit/prior_cost.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// The largest number of markers of a recording that are listed one by one.
constexpr size_t kMostListed = 6;
// A single number that is more standard deviations of its prior away from the prior's mean is a
// conflict.
constexpr double kConflict = 3;
// A scan is reported where the share of its points that were compared is less than this fraction of
// the share in the best frame.
constexpr double kFewestCompared = 0.85;

// The length, in standard deviations of each component, beyond which one of `points` offsets with
// so many components is a conflict: the x with P(χ²_components > x²) = P(|N| > 3)/points, where N
// is standard normal. Offsets that obey their prior then give a conflict anywhere among the points
// as rarely as a single number that exceeds kConflict: in 0.27 % of all cases.
double LongestOffset(int components, Eigen::Index points) {
  const double probability = ChiSquareTail(kConflict * kConflict, 1) /
                             static_cast<double>(std::max<Eigen::Index>(1, points));
  double shorter = 0, longer = 40;  // of no offset but one in 10^300
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (shorter + longer);
    (ChiSquareTail(middle * middle, components) > probability ? shorter : longer) = middle;
  }
  return longer;
}

// A fit is silently wrong, with narrow intervals, where the truth lies far outside of the range on
// a card from which a parameter has its prior.
void AddModelConflicts(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                       std::vector<PriorConflict>* conflicts) {
  const std::vector<ModelParameter>& fitted = problem.study().fitted;
  for (size_t k = 0; k < fitted.size(); ++k) {
    const CalibratedParameter& prior = fitted[k].prior;
    const double deviations = std::abs(FromPriorMean(prior, values[static_cast<Eigen::Index>(k)]));
    if (deviations > kConflict)
      conflicts->emplace_back(ModelParameterConflict{prior.name, fitted[k].unit, deviations,
                                                     PriorMeanOf(prior), prior.has_default_prior});
  }
}

void AddNuisanceConflicts(const RecordingModel& model, const RecordingMisfit& misfit,
                          std::vector<PriorConflict>* conflicts) {
  const auto& own = model.nuisances();
  for (size_t k = 0; k < own.size() && misfit.nuisance.size() > 0; ++k) {
    const CalibratedParameter& prior = own[k].prior;
    const double deviations =
        std::abs(misfit.nuisance[static_cast<Eigen::Index>(k)]) / prior.prior_deviation;
    if (deviations > kConflict)
      conflicts->emplace_back(NuisanceParameterConflict{prior.name, deviations});
  }
}

// `deviation`, m, is that of the places.
void AddMarkerConflicts(const RecordingMisfit& misfit, const Recording& recording, double deviation,
                        std::vector<PriorConflict>* conflicts) {
  if (!misfit.has_own_places) return;
  const Eigen::RowVectorXd distance = misfit.place_offset.colwise().norm();
  const double longest = LongestOffset(3, distance.size()) * deviation;
  std::vector<int> conflicting;
  for (int m = 0; m < distance.size(); ++m)
    if (distance[m] > longest) conflicting.push_back(m);
  std::stable_sort(conflicting.begin(), conflicting.end(),
                   [&](int a, int b) { return distance[a] > distance[b]; });
  for (size_t k = 0; k < conflicting.size() && k < kMostListed; ++k) {
    const int m = conflicting[k];
    conflicts->emplace_back(MarkerConflict{misfit.name,
                                           recording.markers.names[static_cast<size_t>(m)],
                                           misfit.place_offset.col(m), deviation});
  }
  if (conflicting.size() > kMostListed)
    conflicts->emplace_back(MarkerConflictCount{misfit.name, static_cast<int>(conflicting.size()),
                                                static_cast<int>(distance.size())});
}

// The places of tracked points are read off the first frame, in which the object must be
// undeformed. Points off a given reference shape show that it is not, or that shape and points do
// not belong together.
void AddReferenceShapeConflict(const PredictionStudy& study, const PredictedRecording& item,
                               const Body& body, std::vector<PriorConflict>* conflicts) {
  const Recording& recording = item.recording;
  if (!HasTrackedPoints(recording) || recording.reference.source == ReferenceSource::kFirstFrame)
    return;
  const Eigen::VectorXd distance =
      SurfaceSearch(body.boundary.surface).Nearest(recording.markers.places).distance;
  const double rms = std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size()));
  if (rms > kConflict * study.place_deviation)
    conflicts->emplace_back(
        ReferenceShapeConflict{item.name, item.frames.front(), rms, study.place_deviation});
}

void AddScanConflicts(const ScanSettings& scan, const RecordingMisfit& misfit,
                      const RecordingModel& model, std::vector<PriorConflict>* conflicts) {
  const double longest = LongestOffset(1, misfit.place_offset.size()) * scan.shape_deviation;
  const auto conflicting = (misfit.place_offset.array().abs() > longest).count();
  if (conflicting > 0)
    conflicts->emplace_back(PatchConflict{
        misfit.name, static_cast<int>(conflicting), static_cast<int>(misfit.place_offset.cols()),
        misfit.place_offset.cwiseAbs().maxCoeff(), scan.shape_deviation});
  const std::vector<int> lost = model.LostFrames(misfit.misfit, kFewestCompared);
  if (!lost.empty())
    conflicts->emplace_back(UnmatchedScans{misfit.name, static_cast<int>(lost.size()),
                                           static_cast<int>(misfit.misfit.frames.size()),
                                           model.FrameTime(lost.front()), kFewestCompared});
}

}  // namespace

std::vector<PriorConflict> FindPriorConflicts(const CalibrationProblem& problem,
                                              const Eigen::VectorXd& values,
                                              const std::vector<RecordingMisfit>& misfits) {
  std::vector<PriorConflict> conflicts;
  AddModelConflicts(problem, values, &conflicts);
  const PredictionStudy& study = problem.study();
  for (size_t r = 0; r < misfits.size(); ++r) {
    const RecordingModel& model = problem.models()[r];
    const PredictedRecording& item = study.recordings[r];
    AddNuisanceConflicts(model, misfits[r], &conflicts);
    if (item.ShowsScans()) {
      AddScanConflicts(study.scan, misfits[r], model, &conflicts);
    } else {
      AddMarkerConflicts(misfits[r], item.recording, PlaceDeviation(study, item, problem.noise()),
                         &conflicts);
      AddReferenceShapeConflict(study, item, *problem.body(), &conflicts);
    }
  }
  return conflicts;
}

}  // namespace lacuna
