#include "diagnosis/candidate_effect.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

bool AreNeighbours(const VariantPosition& a, const VariantPosition& b) {
  // Among the principal axes and their diagonals, an axis and the diagonals next to it.
  constexpr double kNeighbourAngle = 1;  // rad
  const bool in_line = a.line > 0 && a.line == b.line && std::abs(a.number - b.number) == 1;
  const bool is_near =
      a.spacing > 0 && b.spacing > 0 && (a.place - b.place).norm() < std::min(a.spacing, b.spacing);
  return in_line || is_near || std::abs(a.axis.dot(b.axis)) > std::cos(kNeighbourAngle);
}

double PlausibleScale(const ParameterCard& card) {
  const double null = std::isnan(card.null_value) ? 0 : card.null_value;
  return std::max(std::abs(card.plausible_min - null), std::abs(card.plausible_max - null));
}

std::vector<CandidateAmount> AmountsOf(const CandidateEffect& candidate) {
  if (candidate.IsPilot()) return {{"share", "", 1, true}};
  std::vector<CandidateAmount> amounts;
  for (const int index : candidate.amplitude) {
    const ParameterCard parameter = candidate.CardOf(index);
    amounts.push_back({parameter.name, parameter.dimension.unit, PlausibleScale(parameter),
                       parameter.bounds.min >= parameter.null_value});
  }
  return amounts;
}

std::vector<MisfitDirection> DirectionsOf(const std::vector<CandidateEffect>& candidates) {
  std::vector<MisfitDirection> directions;
  for (const CandidateEffect& candidate : candidates)
    for (const int parameter : candidate.amplitude)
      directions.push_back({.perturbation = {.effect = candidate.effect, .parameter = parameter}});
  return directions;
}

}  // namespace lacuna
