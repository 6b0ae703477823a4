#include "diagnosis/pilot_hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.h"
#include "diagnosis/model_change.h"
#include "diagnosis/plane_proposals.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "effects/plane_contact.h"

namespace lacuna {
namespace {

// NaN: the law has no such parameter.
double ParameterOf(const Effect& effect, const std::string& name) {
  const int index = ParameterIndex(effect.Card(), name);
  return index < 0 ? std::nan("") : effect.Parameters()[index];
}

double ContactStiffness(const Body& body, const Effect& material) {
  const ParameterCard& card = PlaneContactCard().parameters.front();
  const double size = std::cbrt(body.weight.sum() / body.ElementCount());
  return std::clamp(
      kThresholds.pilots.stiffness_ratio * ParameterOf(material, "young_modulus") / size,
      card.plausible_min, card.plausible_max);
}

CandidateEffect Contact(const ProposedPlane& plane, double stiffness, double friction) {
  CandidateEffect candidate;
  candidate.type = PlaneContactCard().type;
  candidate.variant =
      fmt::format("normal ({:.2g}, {:.2g}, {:.2g}), at {:.1f} mm{}", plane.normal.x() + 0.0,
                  plane.normal.y() + 0.0, plane.normal.z() + 0.0, 1e3 * plane.offset,
                  friction > 0 ? ", with friction" : "");
  candidate.effect = MakePlaneContact({.normal = plane.normal,
                                       .offset = plane.offset,
                                       .stiffness = stiffness,
                                       .friction = friction});
  candidate.refined["offset"] = kThresholds.pilots.plane_offset;
  if (friction > 0) candidate.refined["friction"] = friction;
  return candidate;
}

// The other elasticity laws whose parameters the material has all.
std::vector<CandidateEffect> OtherLaws(const Effect& material) {
  std::vector<CandidateEffect> laws;
  for (const CatalogueEntry& entry : Catalogue()) {
    const EffectCard& card = *entry.card;
    if (entry.kind != CatalogueEntry::Kind::kMaterial || card.type == material.Card().type)
      continue;
    Eigen::VectorXd moduli(card.parameters.size());
    for (size_t k = 0; k < card.parameters.size(); ++k)
      moduli[static_cast<Eigen::Index>(k)] = ParameterOf(material, card.parameters[k].name);
    if (!moduli.allFinite()) continue;
    CandidateEffect candidate;
    candidate.type = card.type;
    candidate.variant = "in place of " + material.Card().type;
    candidate.effect = entry.make(moduli);
    candidate.replaces_material = true;
    laws.push_back(std::move(candidate));
  }
  return laws;
}

}  // namespace

PilotHypotheses RunPilots(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          const LinearisedMisfit& misfit, const std::vector<std::string>& without,
                          const std::function<void()>& on_frame) {
  const PredictionStudy study = problem.StudyAt(values);
  const Effect& material = *study.effects.front();
  const auto is_wanted = [&](const std::string& type) {
    return std::count(without.begin(), without.end(), type) == 0;
  };
  PilotHypotheses pilots;
  std::vector<CandidateEffect> candidates;
  for (const CandidateEffect& law : OtherLaws(material))
    if (is_wanted(law.type)) candidates.push_back(law);
  const std::string& contact = PlaneContactCard().type;
  if (is_wanted(contact)) {
    std::vector<ProposedPlane> planes = ProposePlanes(problem, values, misfit);
    planes.resize(std::min(planes.size(), kThresholds.pilots.most_planes));
    const double stiffness = ContactStiffness(*problem.body(), material);
    for (const ProposedPlane& plane : planes) candidates.push_back(Contact(plane, stiffness, 0));
    if (planes.empty())
      pilots.untried.push_back(
          {contact,
           "there is no plane that the predicted body crosses and the measured one does not"});
    else
      candidates.push_back(Contact(planes.front(), stiffness, kThresholds.pilots.friction));
  }

  std::vector<LinearisedMisfit> runs(candidates.size());
  ParallelFor(static_cast<int64_t>(candidates.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    const PredictionStudy changed = WithCandidate(study, candidates[at]);
    const CalibrationProblem pilot(changed, problem.body()->mesh);
    runs[at] = pilot.Linearise(values,
                               {.correspondences = &misfit, .near = &misfit, .on_frame = on_frame});
  });
  std::map<std::string, std::string> failed;
  for (size_t k = 0; k < candidates.size(); ++k) {
    CandidateEffect& candidate = candidates[k];
    const LinearisedMisfit& run = runs[k];
    if (!run.usable) {
      failed.try_emplace(candidate.type, "its pilot cannot be simulated: " + run.message);
    } else {
      pilots.tried.push_back({std::move(candidate), run.residual - misfit.residual});
    }
  }
  for (const auto& [type, why] : failed) {
    const bool tried = std::any_of(
        pilots.tried.begin(), pilots.tried.end(),
        [&, type = type](const PilotHypothesis& pilot) { return pilot.candidate.type == type; });
    if (!tried) pilots.untried.push_back({type, why});
  }
  return pilots;
}

}  // namespace lacuna
