// An independent error in the time of each frame.
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/single_frame_columns.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "time_jitter";
  card.title = "the times of single frames";
  card.directions = "each frame later by a time of its own";
  card.prior = "a tenth of the time between frames";
  card.residual_when_present =
      "The residual is proportional to the velocity, with another factor in each frame.";
  card.advice = "check the camera's clock and its exposure";
  card.acts_on_single_frames = true;
  card.needs_few_frames = true;
  card.trial.control = "time_jitter";
  card.trial.control_position = 4;
  card.trial.time_deviation = 0.0015;
  return card;
}

bool HasTooManyFrames(const LinearisedMisfit::Part& points) {
  return points.layout.times.size() > kThresholds.nuisances.most_single_frames;
}

// The number of columns for all recordings.
Eigen::Index AllColumns(const LinearisedMisfit& misfit) {
  size_t columns = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    if (part.IsOfPoints() && !HasTooManyFrames(part)) columns += part.layout.times.size();
  return static_cast<Eigen::Index>(columns);
}

std::optional<NuisanceCandidate> Make(const RecordingContext& at) {
  NuisanceCandidate candidate;
  candidate.what = "the times of single frames of " + at.Name();
  const Eigen::Index rows = at.misfit.residual.size();
  if (HasTooManyFrames(at.part)) {
    candidate.left_out = {at.Name()};
    return candidate;
  }
  candidate.untried = WhyTooLarge(rows, AllColumns(at.misfit));
  if (!candidate.untried.empty()) return candidate;
  candidate.columns.resize(rows, at.Frames());
  for (Eigen::Index own = 0; own < at.Frames(); ++own)
    candidate.columns.col(own) = at.Column([&](Eigen::Index frame, int series) {
      return frame == own ? at.part.speed[frame * at.part.layout.series + series] : 0.0;
    });
  candidate.priors.assign(static_cast<size_t>(at.Frames()),
                          {0, kThresholds.nuisances.frame_time * at.spacing, false});
  return candidate;
}

}  // namespace

NuisanceEntry TimeJitterNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
