// Makes the recordings of a sealed case: a motion-capture system films the true bar.
//
// The truth differs from the model that must explain it in its mesh (finer elements, another
// subdivision), its step, its shape (within 0.2 %) and its clamp; the markers' places are told to
// within 0.2 mm, and the noise is correlated in time.
#ifndef LACUNA_TRIALS_TRIAL_FILM_H_
#define LACUNA_TRIALS_TRIAL_FILM_H_

#include <filesystem>

#include "trials/trial_case.h"

namespace lacuna {

// Writes <folder>/recording_1 … and experiment.yaml, whose model lacks the hidden effects. A rough
// film, with elements and steps like the model's, only serves to find out how large a hidden effect
// must be. Throws InputError where the true motion cannot be simulated, and says when.
void FilmCase(const TrialCase& trial, const std::filesystem::path& folder, bool rough = false);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_FILM_H_
