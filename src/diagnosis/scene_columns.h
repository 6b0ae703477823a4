// The columns that the rankings of one scene share.
//
// A scene is one body in one set of recordings. The columns of the mesh, the time step, the
// object's dimensions and the extent of the grips, and those of the pilots, are differences of
// simulations, which cost more than all tangents of a ranking together. They hardly change when the
// parameters move a little, so that further rankings along nearly the same motion take them over.
#ifndef LACUNA_DIAGNOSIS_SCENE_COLUMNS_H_
#define LACUNA_DIAGNOSIS_SCENE_COLUMNS_H_

#include <optional>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/mesh_limit.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/pilot_hypotheses.h"

namespace lacuna {

struct SceneColumns {
  std::vector<NuisanceCandidate> nuisances;  // those with NuisanceCard::is_shared_in_scene
  std::optional<PilotHypotheses> pilots;     // empty: not simulated yet
  // What the fit has found about the mesh; empty: nothing.
  std::optional<OtherMesh> other_mesh = {};

  // The columns for the same recordings, simulated with another time step: without the columns of
  // the step, and without the pilots.
  SceneColumns ForOtherStep() const;
  // The columns for the beginnings of the recordings: the rows of so many first frames as each
  // recording of `beginnings` has, without the pilots. `whole`: the layout of the columns, with the
  // parts of each of them in the same order. CHECKs the numbers of recordings and frames.
  SceneColumns ForFirstFrames(const std::vector<LinearisedMisfit::Part>& whole,
                              const std::vector<PredictedRecording>& beginnings) const;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SCENE_COLUMNS_H_
