// Nuisances: errors of the discretisation, the object's shape, the grips and the measurement, which
// can imitate a missing physical effect.
//
// To first order a nuisance changes the residual r (predicted − measured) to
//   r + C a,   a ~ N(m, diag s²),
// where the columns of C are the directions of the nuisance and a its unknown amounts. A nuisance
// is therefore weighed by the same evidence as an effect (analysis/linear_evidence.h).
//
// Everything that the rest of the program must know about a nuisance stands on its card. The
// ranking asks the card whether the nuisance belongs to every model, the verdict how it competes
// with effects, the sealed trials how to put it into a synthetic recording. A new nuisance is one
// file (nuisance_NAME.cc), one line in nuisance_catalogue.cc, one test and one row in
// docs/diagnosis.md. Cards are constant after their construction, so any thread may read them.
#ifndef LACUNA_DIAGNOSIS_NUISANCE_H_
#define LACUNA_DIAGNOSIS_NUISANCE_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "prediction/prediction_study.h"

namespace lacuna {

enum class NuisanceSource { kDiscretisation, kShape, kGrip, kMeasurement };

// What the sealed trials (trials/trial_suite.h) do with a nuisance.
struct NuisanceTrial {
  // An effect is hidden at a multiple of its detectable size; this nuisance raises that size,
  // because it could explain a part of what the effect changes.
  bool limits_detection = false;
  // The name of the hard controls, cases without a hidden effect, that have this nuisance, and its
  // position among them, from 1; 0: there are none. A position that is kept keeps the cases of a
  // seed as they are. One or several of the numbers below say what is wrong with such a case; 0
  // changes nothing.
  std::string control = "";
  int control_position = 0;
  double least_clamp_error = 0, largest_clamp_error = 0;  // m: the clamp ends elsewhere, either way
  double element_volume = 0;                              // m³: of the elements of the model
  double time_deviation = 0;                              // s: σ of the time of each frame
  double frame_shift = 0, frame_rotation = 0;             // m and rad: σ of one misplaced frame
};

struct NuisanceCard {
  std::string name;                   // in results and verdicts, e.g. "grip_compliance"
  std::string title;                  // one phrase, e.g. "the size of the elements"
  std::string directions;             // what the columns are
  std::string prior;                  // how large the amounts are expected to be
  std::string residual_when_present;  // what the residual of a model without it looks like
  std::string advice;                 // what the user can do; without a final full stop
  NuisanceSource source = NuisanceSource::kMeasurement;
  // The nuisance is simulated and bounded, and belongs to every model, whatever its evidence.
  bool is_always_in_model = false;
  // The columns are differences of further simulations, which rankings along the same motion share
  // (scene_columns.h). RankAlong() computes them anew along the motion of a refit.
  bool is_shared_in_scene = false;
  // Each recording has amounts of its own for the parameters that a comparison of the recordings
  // (recording_agreement.h) estimates, which is therefore made without them.
  bool separates_recordings = false;
  // Each frame has amounts of its own: those of the fitted frames predict nothing in held-out ones.
  bool acts_on_single_frames = false;
  // Recordings with more frames than NuisanceThresholds::most_single_frames are left out.
  bool needs_few_frames = false;
  // The nuisance changes natural frequencies, which a linear column follows for a short time only.
  // First order therefore underrates it, also in a model that is fitted with it.
  bool outgrows_first_order = false;
  // A nuisance of each recording is tried where this many frames are used or more.
  int least_frames = 3;
  // A shorter time step reduces the nuisance: the diagnosis may start again with one.
  bool shrinks_with_time_step = false;
  NuisanceTrial trial = {};
};

// A study, and the priors of the amounts of a nuisance that it does not contain yet.
struct StudyBesideNuisance {
  PredictionStudy study;
  std::vector<LinearPrior> priors;
};

// A nuisance of one fitted model, with its directions there.
struct NuisanceCandidate {
  NuisanceCard card;
  std::string what;              // the card's title, with a place or a time where it has one
  double selection_penalty = 0;  // ln of the number of alternatives from which it was selected
  Eigen::MatrixXd columns = {};  // C: rows of a LinearisedMisfit × directions, m per unit amount
  std::vector<LinearPrior> priors = {};  // of the amounts, one per column
  // What is not known about C: an error of the size of these columns, in any direction. Without
  // columns, C is known.
  Eigen::MatrixXd unknown = {};
  // The names of the recordings that C leaves out because they have more frames than
  // NuisanceThresholds::most_single_frames. If C has no columns, the nuisance cannot be tried.
  std::vector<std::string> left_out = {};
  // Puts these amounts of the nuisance into the study; the priors become those of what is beyond
  // them. C describes the motion without the nuisance, so that a refit with large amounts goes on
  // from there, with the columns that the maker gives for that study. Empty: refits keep C.
  std::function<void(const Eigen::VectorXd& amounts, StudyBesideNuisance* beside)> apply = {};
  // Why the nuisance cannot be tried, although it applies: C has no columns then. Empty: it can.
  std::string untried = "";
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_NUISANCE_H_
