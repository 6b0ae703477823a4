#include "diagnosis/removed_misfit.h"

namespace lacuna {

ByDataKind RemovedMisfit(const FittedHypothesis& before, const FittedHypothesis& after,
                         const NoiseLevel& noise, const std::vector<DataKind>& kinds) {
  const auto squares = [&](const FittedHypothesis& hypothesis) {
    return SumsByKind(WhitenedResidual(hypothesis, noise).cwiseAbs2(), hypothesis.misfit, kinds);
  };
  ByDataKind removed = squares(before);
  const ByDataKind left = squares(after);
  for (const auto& [name, kind] : kDataKinds) removed.*kind -= left.*kind;
  return removed;
}

std::optional<ByDataKind> RemovedMisfit(const FittedHypothesis& before,
                                        const FittedHypothesis& after, const NoiseLevel& noise,
                                        const CalibrationProblem& problem) {
  if (!HasSeveralKinds(problem)) return std::nullopt;
  return RemovedMisfit(before, after, noise, KindsOfParts(before.misfit, problem));
}

}  // namespace lacuna
