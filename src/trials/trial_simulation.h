// Simulates the recordings of a sealed case: a motion-capture system or depth cameras observe the
// true bar.
//
// The truth differs from the model that must explain it in its mesh (finer elements, another
// subdivision), its time step, its shape (within 0.2 %) and its clamp. The places of the markers
// are known only to within 0.2 mm, and the noise is correlated in time.
#ifndef LACUNA_TRIALS_TRIAL_SIMULATION_H_
#define LACUNA_TRIALS_TRIAL_SIMULATION_H_

#include <filesystem>

#include "trials/trial_case.h"

namespace lacuna {

// Writes <folder>/recording_1, … and experiment.yaml, whose model lacks the hidden effects. With
// `rough` the truth has elements and time steps like those of the model; such a recording serves to
// find out how large a hidden effect must be to be detectable. Throws InputError, with the reason,
// if the true motion cannot be simulated or a file cannot be written.
void SimulateCase(const TrialCase& trial, const std::filesystem::path& folder, bool rough = false);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_SIMULATION_H_
