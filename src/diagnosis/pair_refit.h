// Two effects at once: the model with a refitted effect as the baseline of a further one.
#ifndef LACUNA_DIAGNOSIS_PAIR_REFIT_H_
#define LACUNA_DIAGNOSIS_PAIR_REFIT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/decision_input.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/extended_problem.h"

namespace lacuna {

// A refitted effect and everything else ranked anew along its motion, with the nuisances that
// `decided`, the baseline's ranking, has adopted. What an effect leaves may be a hundredth of what
// it explains, so that the columns of the mesh and the time step must be those of its own motion.
// The effect keeps its size in them.
// Pilots are simulated again only if the effect is one of them, so that it does not stand beside
// itself. `baseline` must outlive it. The constructor throws Interrupted.
class RefittedModel {
 public:
  RefittedModel(const BaselineModel& baseline, const ScoredVariant& effect,
                const EffectRefit& refit, const std::vector<std::string>& without,
                const DecidedBase& decided);
  RefittedModel(const RefittedModel&) = delete;

  const std::string& effect() const { return effect_; }
  const EffectRanking& ranking() const { return ranking_; }

  // The fit with a further effect, weighed with this noise against `first`, the log evidence of the
  // refit with the effect alone; nothing if that was not tried or cannot be fitted. Throws
  // Interrupted.
  std::optional<WeighedPair> RefitWith(const std::string& further, double first,
                                       const NoiseLevel& noise) const;

 private:
  const BaselineModel& baseline_;
  std::string effect_;
  PredictionStudy study_;
  CalibrationProblem problem_;  // of study_
  Eigen::VectorXd values_;
  EffectRanking ranking_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PAIR_REFIT_H_
