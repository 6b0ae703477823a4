#include "diagnosis/rival_pairs.h"

#include <gtest/gtest.h>

#include <memory>

namespace lacuna {
namespace {

// An effect with a refit of this evidence.
RankedEffect Refitted(const std::string& type, double evidence) {
  RankedEffect effect;
  effect.scored.candidate.type = type;
  effect.refitted = true;
  effect.evidence = evidence;
  return effect;
}

RankedEffect NotRefitted(const std::string& type) {
  RankedEffect effect;
  effect.scored.candidate.type = type;
  return effect;
}

ScoredEffect Scored(const std::string& type, double evidence) {
  ScoredEffect effect;
  effect.candidate.type = type;
  effect.score.evidence = evidence;
  return effect;
}

class Rivals : public testing::Test {
 protected:
  // Drag and a branch are most probable; everything was ranked along the motion with drag.
  Rivals() {
    pair_.kind = HypothesisProbability::Kind::kPair;
    pair_.names = {"drag", "branch"};
    families_ = {{"drag", EffectFamily::kLossOutside},
                 {"mass_damping", EffectFamily::kLossOutside},
                 {"slip", EffectFamily::kLossOutside},
                 {"branch", EffectFamily::kLossInside},
                 {"plastic", EffectFamily::kLossInside},
                 {"damping", EffectFamily::kLossInside},
                 {"gravity", EffectFamily::kSteadyForce},
                 {"contact", EffectFamily::kOther},
                 {"law", EffectFamily::kOther}};
    EffectRanking along;
    along.effects = {Scored("branch", 40), Scored("plastic", 25), Scored("gravity", 20),
                     Scored("damping", 1)};
    const auto ranking = std::make_shared<const EffectRanking>(along);
    ranked_.along = AlongRefit{"drag", ranking, ranking};
    ranked_.effects = {Refitted("drag", 100),   Refitted("mass_damping", 95),
                       NotRefitted("slip"),     NotRefitted("branch"),
                       NotRefitted("plastic"),  NotRefitted("damping"),
                       Refitted("gravity", 90), Refitted("contact", 80)};
  }

  // "first, further" of each rival.
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const PairToFit& rival : RivalsOf(pair_, ranked_, families_))
      names.push_back(rival.first + ", " + rival.further);
    return names;
  }

  HypothesisProbability pair_;
  RefittedRanking ranked_;
  std::map<std::string, EffectFamily> families_;
};

// Mass damping costs 5, plasticity 15; slip has no refit, and damping no evidence beside drag.
TEST_F(Rivals, ReplaceOneEffectByAnotherOfItsFamily) {
  EXPECT_EQ(Names(), (std::vector<std::string>{"mass_damping, branch", "drag, plastic"}));
  EXPECT_EQ(RivalsOf(pair_, ranked_, families_)[1].lost, 15);
}

// A refuted effect may be the further one of a pair, but not the first.
TEST_F(Rivals, HaveNoRefutedFirstEffectAndAreNotFitted) {
  ranked_.effects[1].predicts = false;
  ranked_.effects[4] = Refitted("plastic", 20);
  ranked_.effects[4].predicts = false;
  EXPECT_EQ(Names(), (std::vector<std::string>{"drag, plastic"}));
  FittedPair fitted;
  fitted.first = "drag";
  fitted.second.scored.candidate.type = "plastic";
  ranked_.pairs.push_back(fitted);
  EXPECT_TRUE(Names().empty());
}

TEST_F(Rivals, DoNotReplaceAnEffectWithoutAFamily) {
  pair_.names = {"drag", "contact"};
  EXPECT_EQ(Names(), (std::vector<std::string>{"mass_damping, contact"}));
}

// The search for the first effect may have failed, or never have been made.
TEST(FromARefit, IsThePairWithAnEffectFirstThatHasARefit) {
  RefittedRanking ranked;
  ranked.effects = {Refitted("drag", 100), NotRefitted("branch"), NotRefitted("slip"),
                    Refitted("gravity", 0)};
  ranked.effects[3].refit_message = "the simulation has stopped";
  EXPECT_EQ(FromARefit({"drag", "branch"}, ranked).value().first, "drag");
  for (const std::string other : {"branch", "gravity"}) {
    const PairToFit turned = FromARefit({other, "drag", 7}, ranked).value();
    EXPECT_EQ(turned.first, "drag");
    EXPECT_EQ(turned.further, other);
    EXPECT_EQ(turned.lost, 7);
  }
  EXPECT_FALSE(FromARefit({"gravity", "slip"}, ranked).has_value());
}

}  // namespace
}  // namespace lacuna
