#include "diagnosis/refit_reach.h"

#include <glog/logging.h>

#include <cmath>

#include "record/effect_card.h"

namespace lacuna {
namespace {

// Whether a refit of one variant may end at another one of the same effect.
bool MayReach(const CandidateEffect& from, const CandidateEffect& to) {
  // Differences below this share of the plausible scale of a parameter do not count: the places
  // along a body are not exactly on a line. Higher: variants count as reached that are elsewhere.
  constexpr double kSame = 0.01;
  const std::vector<ParameterCard>& parameters = from.effect->Card().parameters;
  const Eigen::VectorXd start = from.effect->Parameters(), end = to.effect->Parameters();
  for (size_t k = 0; k < parameters.size(); ++k) {
    const double there = end[static_cast<Eigen::Index>(k)];
    const double away = std::abs(there - start[static_cast<Eigen::Index>(k)]);
    if (away <= kSame * PlausibleScale(parameters[k])) continue;
    if (!IsMovedByRefit(from, k)) return false;
    const auto range = from.known.find(parameters[k].name);
    if (range != from.known.end() && (there < range->second.min || there > range->second.max))
      return false;
  }
  return true;
}

}  // namespace

bool IsMovedByRefit(const CandidateEffect& candidate, size_t parameter) {
  const ParameterCard& card = candidate.effect->Card().parameters[parameter];
  if (candidate.replaces_material || card.setting) return false;
  const auto known = candidate.known.find(card.name);
  if (known != candidate.known.end() && known->second.IsHeld()) return false;
  return !candidate.IsPilot() || candidate.refined.contains(card.name);
}

double ReachableShare(const CandidateEffect& candidate,
                      const std::vector<CandidateEffect>& candidates) {
  size_t variants = 0, reached = 0;
  for (const CandidateEffect& other : candidates) {
    if (other.type != candidate.type) continue;
    ++variants;
    reached += MayReach(candidate, other);
  }
  CHECK_GT(reached, 0u) << candidate.type << " is not among the candidates";
  return static_cast<double>(reached) / static_cast<double>(variants);
}

}  // namespace lacuna
