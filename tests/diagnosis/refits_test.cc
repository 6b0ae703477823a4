#include "diagnosis/refits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "effects/catalogue.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

RankedEffect Ranked(const std::string& type, double evidence) {
  RankedEffect effect;
  effect.scored.candidate.type = type;
  const CatalogueEntry* entry = FindEntry(type);
  Eigen::VectorXd values(static_cast<Eigen::Index>(entry->card->parameters.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = entry->card->parameters[static_cast<size_t>(k)].plausible_max;
  effect.scored.candidate.effect = entry->make(values);
  effect.refitted = evidence > 0;
  effect.evidence = evidence;
  return effect;
}

// A member of a family is not named before the others have been refitted, even if first order
// promised nothing of them.
TEST(Refits, TheFamilyOfTheBestEffectMayBeTakenForIt) {
  std::vector<RankedEffect> effects{Ranked("gravity", 2), Ranked("drag", 20), Ranked("pressure", 0),
                                    Ranked("mass_damping", 0)};
  EXPECT_THAT(LookAlikesOfBest(effects), ElementsAre(3));
  effects[1].scored.look_alikes = {"pressure"};
  EXPECT_THAT(LookAlikesOfBest(effects), ElementsAre(2, 3));
  for (RankedEffect& effect : effects) effect.evidence = 0;
  EXPECT_THAT(LookAlikesOfBest(effects), IsEmpty());
}

}  // namespace
}  // namespace lacuna
