// Simulates the recordings of a sealed case: a motion-capture system or depth cameras observe the
// true bar.
//
// The truth differs from the model that must explain it in its mesh (finer elements, another
// subdivision), its time step, its shape (within 0.2 %) and its clamp. The recorded place of each
// marker is off by normal errors with a standard deviation of 0.1 mm along each axis
// (kTrialPlaceError); the model is told 0.2 mm (`place_deviation`). The noise is correlated in
// time.
#ifndef LACUNA_TRIALS_TRIAL_SIMULATION_H_
#define LACUNA_TRIALS_TRIAL_SIMULATION_H_

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "core/error.h"
#include "plan/protocol.h"
#include "trials/trial_case.h"
#include "trials/trial_recording.h"

namespace lacuna {

// Thrown where the motion of the bar of a case cannot be simulated. Another draw of the case may be
// possible then; other InputErrors, such as those of a file, do not depend on the draw.
class SimulationFailure : public InputError {
 public:
  using InputError::InputError;
};

// What is done to the bar while it is recorded.
struct TrialProcedure {
  std::vector<double> times;                       // s, at which the frames are taken
  std::function<Eigen::Isometry3d(double)> clamp;  // its motion from its undeformed place, time s
  Eigen::Vector3d hold_force = Eigen::Vector3d::Zero();  // N, of the hand until the release
  std::optional<Protocol::Weight> weight = {};           // fixed to the bar
  std::vector<double> cell_times = {};  // s, ascending, at which the force of the clamp is wanted
};

// The motion of the true bar. With `rough` it has elements and time steps like those of the model.
// Throws SimulationFailure, with the reason, if it cannot be simulated.
TrueMotion SimulateTruth(const TrialCase& trial, const TrialProcedure& procedure,
                         bool rough = false);

// Writes <folder>/recording_1, … and experiment.yaml, whose model lacks the hidden effects. A
// `rough` recording serves to find out how large a hidden effect must be to be detectable. Throws
// SimulationFailure, with the reason, if the true motion cannot be simulated, and InputError if a
// file cannot be written.
void SimulateCase(const TrialCase& trial, const std::filesystem::path& folder, bool rough = false);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_SIMULATION_H_
