// One misplaced frame of a recording: the one with the largest residual.
#include <fmt/format.h>

#include <cmath>

#include "diagnosis/nuisance_catalogue.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "bad_frame";
  card.title = "a single frame";
  card.directions = "the frame with the largest residual shifted and rotated";
  card.prior = "1 mm and 0.02 rad";
  card.residual_when_present = "One frame is displaced like a rigid body; its neighbours are not.";
  card.advice = "leave that frame out, or measure it again";
  card.acts_on_single_frames = true;
  card.trial.control = "bad_frame";
  card.trial.control_position = 2;
  card.trial.frame_shift = 8e-4;
  card.trial.frame_rotation = 0.01;
  return card;
}

Eigen::Index WorstFrame(const RecordingContext& at) {
  Eigen::Index worst = 0;
  double most = -1;
  for (Eigen::Index frame = 0; frame < at.Frames(); ++frame) {
    const Eigen::Index series = at.part.layout.series;
    const double square =
        at.whitened_residual.segment(at.part.first_row + frame * series, series).squaredNorm();
    if (square <= most) continue;
    most = square;
    worst = frame;
  }
  return worst;
}

std::optional<NuisanceCandidate> Make(const RecordingContext& at) {
  const Eigen::Index worst = WorstFrame(at);
  NuisanceCandidate candidate;
  candidate.what = fmt::format("the frame at {:.3f} s of {}",
                               at.part.layout.times[static_cast<size_t>(worst)], at.Name());
  candidate.selection_penalty = std::log(static_cast<double>(at.Frames()));
  candidate.columns =
      at.RigidColumns([&](Eigen::Index frame) { return frame == worst ? 1.0 : 0.0; });
  candidate.priors = RigidMotionPriors();
  return candidate;
}

}  // namespace

NuisanceEntry BadFrameNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
