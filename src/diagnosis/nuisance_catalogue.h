// The written list of all nuisances, and what turns it into columns for one fitted model.
//
// There are three kinds: nuisances of the model (mesh, time step, shape, extent of the grips, scale
// of the loads, differences between the recordings), of each grip, and of each recording (clock,
// frames). A kind has one signature, so that nuisance_NAME.cc contains a card and one function. All
// columns refer to the rows of the same LinearisedMisfit, in m per unit amount.
#ifndef LACUNA_DIAGNOSIS_NUISANCE_CATALOGUE_H_
#define LACUNA_DIAGNOSIS_NUISANCE_CATALOGUE_H_

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/mesh_limit.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance.h"

namespace lacuna {

// The fitted model for which nuisances are made. References must outlive it.
struct NuisanceContext {
  const CalibrationProblem& problem;
  const Eigen::VectorXd& values;   // the fitted values of problem.parameters()
  const LinearisedMisfit& misfit;  // at `values`, with the Jacobian of the parameters
  const GripMotions& grips;
  const Eigen::MatrixXd& grip_columns;    // changes of the rows by grips.directions
  const OtherMesh* other_mesh = nullptr;  // as in MakeOtherMesh(); null: unknown
};

// One recording of that model, with NuisanceCard::least_frames or more.
struct RecordingContext {
  const CalibrationProblem& problem;
  const LinearisedMisfit& misfit;
  const LinearisedMisfit::Part& part;        // the rows of its points
  const Eigen::VectorXd& whitened_residual;  // all rows, in σ
  double spacing = 0;                        // s, mean time between frames; of one frame 0
  Eigen::Vector3d centre;                    // m, of the object at rest

  const std::string& Name() const { return problem.models()[part.recording].recording().name; }
  Eigen::Index Frames() const { return static_cast<Eigen::Index>(part.layout.times.size()); }
  // A column with value(frame, series) in the rows of the points and 0 elsewhere.
  Eigen::VectorXd Column(const std::function<double(Eigen::Index frame, int series)>& value) const;
  // Six columns: the frames move rigidly, each by this share of a shift along three axes (per m)
  // and of a rotation about three axes through the centre (per rad). 0 where nothing was observed.
  Eigen::MatrixXd RigidColumns(const std::function<double(Eigen::Index frame)>& share) const;
};

// A nuisance that cannot be simulated: without columns, with the reason, a part of a sentence.
NuisanceCandidate Untried(const NuisanceContext& context, const std::string& why);

// The priors of three shifts and three rotations of something that may be misplaced.
std::vector<LinearPrior> RigidMotionPriors();

// The makers fill everything but the card, which comes from the entry; without a result the
// nuisance does not apply. A candidate without columns says why it cannot be simulated (Untried()),
// or which recordings have too many frames for it (NuisanceCandidate::left_out). A nuisance of
// every model must not vanish in silence: without it, the hypotheses claim more than is known. A
// maker may throw Interrupted.
using ModelNuisance = std::optional<NuisanceCandidate> (*)(const NuisanceContext& context);
using GripNuisance = NuisanceCandidate (*)(const GripMotions::Grip& grip,
                                           const Eigen::MatrixXd& grip_columns);
using RecordingNuisance = std::optional<NuisanceCandidate> (*)(const RecordingContext& context);

struct NuisanceEntry {
  NuisanceCard card;
  std::variant<ModelNuisance, GripNuisance, RecordingNuisance> make;
};

// All nuisances. The order decides which of two equally good ones comes first.
const std::vector<NuisanceEntry>& NuisanceCatalogue();

// The card with this name; null: there is none.
const NuisanceCard* FindNuisance(const std::string& name);

// What the sealed trials do with the nuisances that have hard controls, in the order of these.
std::vector<NuisanceTrial> NuisanceControls();

// The nuisances of the model: what a finer mesh and a shorter step change beyond what the
// parameters can compensate for, the object's dimensions, the noise of the grips' markers, the
// extent of the grips, the scale of the loads, and parameters that differ between recordings. Those
// that are in `known`, by the names of their cards, and were simulated, are taken from there.
std::vector<NuisanceCandidate> ModelNuisances(const NuisanceContext& context,
                                              const std::vector<NuisanceCandidate>& known = {});
// The nuisance of the model with this name, which must be one; nothing where it does not apply.
std::optional<NuisanceCandidate> ModelNuisanceNamed(const std::string& name,
                                                    const NuisanceContext& context);
// The nuisances of ModelNuisances() that all rankings of one scene share
// (NuisanceCard::is_shared_in_scene). They do not need `grip_columns`.
std::vector<NuisanceCandidate> SceneNuisances(const NuisanceContext& context);
// The nuisances of ModelNuisances() that belong to every model.
std::vector<NuisanceCandidate> NuisancesOfEveryModel(const NuisanceContext& context);

// The nuisances of each grip; `grip_columns` as in NuisanceContext, after the simulation.
std::vector<NuisanceCandidate> GripNuisances(const GripMotions& grips,
                                             const Eigen::MatrixXd& grip_columns);

// The nuisances of each recording, which need no simulation. The whitened residual of the model
// selects the frame that may be misplaced.
std::vector<NuisanceCandidate> RecordingNuisances(const CalibrationProblem& problem,
                                                  const LinearisedMisfit& misfit,
                                                  const Eigen::VectorXd& whitened_residual);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_NUISANCE_CATALOGUE_H_
