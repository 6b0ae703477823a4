#include "diagnosis/model_change.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/refit_reach.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"

namespace lacuna {
namespace {

void ReplaceMaterial(const std::shared_ptr<const Effect>& law, PredictionStudy* study) {
  const std::shared_ptr<const Effect> before = study->effects.front();
  study->effects.front() = law;
  for (ModelParameter& parameter : study->fitted) {
    for (auto& [effect, index] : parameter.places) {
      if (effect != 0) continue;
      const std::string& name = before->Card().parameters[index].name;
      index = ParameterIndex(law->Card(), name);
      CHECK_GE(index, 0) << law->Card().type << " has no " << name;
    }
  }
}

// Gives added masses the gravity of the model: the last effect, or all effects if that is gravity
// itself and not at its null value. A mass whose gravity is not that of the model before keeps it.
// `before`: the effects without the last one.
void LetMassesFall(const EffectList& before, EffectList* effects) {
  const std::optional<Eigen::Vector3d> added = GravityOf({effects->back()});
  const Eigen::Vector3d known = GravityOf(before).value_or(Eigen::Vector3d::Zero());
  if (!added) {
    effects->back() = WithGravitySetting(effects->back(), known);
  } else if (!added->isZero(0)) {
    for (auto& effect : *effects) {
      const std::optional<Eigen::Vector3d> own = GravitySettingOf(*effect);
      if (own && IsSameGravity(*own, known)) effect = WithGravitySetting(effect, *added);
    }
  }
}

// Limits a parameter to its plausible range with a margin.
void KeepPlausible(const ParameterCard& plausible, CalibratedParameter* prior) {
  const double range = plausible.plausible_max - plausible.plausible_min;
  if (plausible.dimension.SameAs(kAngle)) {
    // Angles are periodic, so a range of fixed ends would exclude some neighbouring directions.
    SetBounds(std::max(prior->min, prior->start - range),
              std::min(prior->max, prior->start + range), plausible.bounds, prior);
    return;
  }
  const double margin = kThresholds.refit.range_margin * range;
  // The place of a pilot comes from the recording and may lie outside of the plausible range.
  const double low =
      std::min(prior->start, plausible.log_scale && plausible.plausible_min > 0
                                 ? kThresholds.refit.log_range_share * plausible.plausible_min
                                 : plausible.plausible_min - margin);
  const double high = std::max(prior->start, plausible.plausible_max + margin);
  SetBounds(std::max(prior->min, low), std::min(prior->max, high), plausible.bounds, prior);
}

// Gives a parameter the mean and the standard deviation of a uniform distribution over a range, on
// the scale on which it is fitted.
void KeepWithin(const CandidateEffect::Range& range, const Bounds& of_card,
                CalibratedParameter* prior) {
  SetBounds(std::min(range.min, prior->start), std::max(range.max, prior->start), of_card, prior);
  if (prior->log_scale) {
    prior->prior_mean = std::sqrt(range.min * range.max);
    prior->prior_deviation = prior->typical = std::log(range.max / range.min) / std::sqrt(12.0);
    return;
  }
  prior->prior_mean = 0.5 * (range.min + range.max);
  prior->prior_deviation = prior->typical = (range.max - range.min) / std::sqrt(12.0);
}

}  // namespace

Eigen::VectorXd StartOfRefit(const ScoredVariant& scored) {
  const CandidateEffect& candidate = scored.candidate;
  Eigen::VectorXd values = candidate.effect->Parameters();
  for (size_t k = 0; k < candidate.amplitude.size(); ++k) {
    const int index = candidate.amplitude[k];
    const ParameterCard parameter = candidate.CardOf(index);
    const double size = parameter.null_value + scored.score.size[static_cast<Eigen::Index>(k)];
    // Not at the null value, where the other parameters have no influence.
    double start = std::clamp(size, parameter.plausible_min, parameter.plausible_max);
    if (start == parameter.null_value) start += 0.01 * PlausibleScale(parameter);
    values[index] = start;
  }
  return values;
}

PredictionStudy WithCandidate(const PredictionStudy& study, const CandidateEffect& candidate) {
  PredictionStudy with = study;
  if (candidate.replaces_material) {
    ReplaceMaterial(candidate.effect, &with);
    return with;
  }
  with.effects.push_back(candidate.effect);
  LetMassesFall(study.effects, &with.effects);
  return with;
}

PredictionStudy WithEffect(const PredictionStudy& study, const ScoredVariant& scored) {
  CandidateEffect own = scored.candidate;
  own.effect = own.effect->WithParameters(StartOfRefit(scored));
  PredictionStudy with = WithCandidate(study, own);
  if (own.replaces_material) return with;
  for (ModelParameter& parameter : ModelParameters(with.effects, ScaleOf(with))) {
    if (parameter.places.front().effect + 1 == with.effects.size()) {
      const int index = parameter.places.front().index;
      const ParameterCard card = own.CardOf(index);
      CalibratedParameter& prior = parameter.prior;
      if (!IsMovedByRefit(own, static_cast<size_t>(index))) continue;
      if (own.prior_centre.size() > 0 && (!prior.log_scale || own.prior_centre[index] > 0))
        prior.prior_mean = own.prior_centre[index];
      if (own.IsPilot()) prior.prior_deviation = own.refined.at(card.name);
      const bool is_amplitude = std::count(own.amplitude.begin(), own.amplitude.end(), index) > 0;
      if (is_amplitude && !prior.log_scale) {
        prior.prior_mean = card.null_value;
        prior.prior_deviation = PlausibleScale(card);
      }
      if (const auto known = own.known.find(card.name); known != own.known.end())
        KeepWithin(known->second, card.bounds, &prior);
      else
        KeepPlausible(card, &prior);
      with.fitted.push_back(parameter);
      continue;
    }
    // A parameter that the added effect shares with the model keeps one value.
    for (ModelParameter& known : with.fitted)
      if (known.places.front() == parameter.places.front()) known.places = parameter.places;
  }
  return with;
}

}  // namespace lacuna
