#include "diagnosis/candidates.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "diagnosis/body_extent.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "record/effect_card.h"

namespace lacuna {
namespace {

// The parameters of the card: from the variant, else from the model, else the default value (NaN if
// there is none). The size of the effect is zero.
Eigen::VectorXd ValuesOf(const EffectCard& card, const CandidateVariant& variant,
                         const CandidateSetting& setting) {
  std::map<std::string, double> known = variant.values;
  const Eigen::Vector3d gravity = GravityOf(setting.effects).value_or(Eigen::Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis)
    known[fmt::format("{}_{}", kGravitySetting, "xyz"[axis])] = gravity[axis];
  const Effect& material = *setting.effects.front();
  for (size_t m = 0; m < material.Card().parameters.size(); ++m)
    known.try_emplace(material.Card().parameters[m].name,
                      material.Parameters()[static_cast<Eigen::Index>(m)]);
  Eigen::VectorXd values(card.parameters.size());
  for (size_t k = 0; k < card.parameters.size(); ++k) {
    const auto found = known.find(card.parameters[k].name);
    values[static_cast<Eigen::Index>(k)] =
        found != known.end() ? found->second : card.parameters[k].default_value;
  }
  for (const int k : SizeParameters(card)) values[k] = card.parameters[k].null_value;
  return values;
}

}  // namespace

std::vector<CandidateEffect> MakeCandidates(const CandidateSetting& setting) {
  const BodyExtent extent = MeasureExtent(setting.body);
  std::vector<CandidateEffect> candidates;
  for (const CatalogueEntry& entry : Catalogue()) {
    const EffectCard& card = *entry.card;
    if (entry.kind != CatalogueEntry::Kind::kEffect || entry.make == nullptr) continue;
    if (card.parameters.empty() || std::isnan(card.parameters[0].null_value)) continue;
    if (std::count(setting.without.begin(), setting.without.end(), card.type) > 0) continue;
    if (!std::all_of(setting.effects.begin(), setting.effects.end(),
                     [&](const auto& effect) { return MayStandBeside(effect->Card(), card); }))
      continue;
    for (const CandidateVariant& variant : VariantsFor(card, extent, setting)) {
      const Eigen::VectorXd values = ValuesOf(card, variant, setting);
      CHECK(values.allFinite()) << card.type << " has a parameter without a value";
      candidates.push_back({card.type, variant.name, entry.make(values), SizeParameters(card)});
      candidates.back().position = variant.position;
      candidates.back().known = variant.known;
      candidates.back().body = setting.scale;
    }
  }
  for (const OwnLaw& law : setting.laws) {
    if (std::count(setting.without.begin(), setting.without.end(), law.name) > 0) continue;
    Eigen::VectorXd values = law.effect->Parameters();
    values[0] = law.effect->Card().parameters[0].null_value;
    candidates.push_back({law.name, "", law.effect->WithParameters(values), {0}});
  }
  return candidates;
}

}  // namespace lacuna
