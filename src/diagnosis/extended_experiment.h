// The experiment of a fitted run with one more effect in its model, or with another elasticity law.
#ifndef LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_
#define LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_

#include <filesystem>
#include <string>

#include "calibration/calibration_run.h"
#include "diagnosis/effect_ranking.h"

namespace lacuna {

// Writes <name>+<effect>.yaml, of an experiment called so, beside the run's folder: it uses the
// run's experiment, starts from the fitted values, has the effect at its expected size and all of
// its parameters fitted (an elasticity law: the moduli that were fitted before), and puts its
// results into <name>+<effect>.
// Returns the file. Throws InputError when an effect of the model has a value that YAML cannot say.
std::filesystem::path WriteExtendedExperiment(const FittedRun& fitted,
                                              const std::filesystem::path& run,
                                              const ScoredEffect& effect);

// Why no fit could tell the effect in these recordings, its plausible sizes being too small for
// them; empty: it could.
std::string WhyUnseen(const ScoredEffect& effect);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_
