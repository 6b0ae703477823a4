// Writes the experiment of a fitted run whose model has one more effect, or another elasticity law.
#ifndef LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_
#define LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_

#include <filesystem>
#include <string>

#include "calibration/calibration_run.h"
#include "diagnosis/effect_ranking.h"

namespace lacuna {

// Writes <name>+<effect>.yaml beside the folder `run` and returns its path. The experiment of that
// name uses the run's experiment, starts from the values of the refit in which the effect was
// judged (without one: from the fitted values and the predicted size), fits all parameters of the
// effect with the priors of that refit, and saves its results in <name>+<effect>. Its
// `explained_misfit` is that of the run and twice the evidence of the effect. An elasticity law
// replaces the law of the run; the moduli that were fitted before are fitted. Throws InputError if
// an effect of the model cannot be written as YAML.
std::filesystem::path WriteExtendedExperiment(const FittedRun& fitted,
                                              const std::filesystem::path& run,
                                              const ScoredEffect& effect);

// Explains why these recordings cannot show the effect at any plausible size. Empty if they can.
std::string WhyUnseen(const ScoredEffect& effect);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENDED_EXPERIMENT_H_
