#include "diagnosis/decision_store.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "diagnosis/decision.h"
#include "diagnosis/synthetic_space.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(DecisionStore, DecidesAgainAsBefore) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(18) - 9 * synthetic.Of("drag"));
  input.refits.push_back({"drag", 30, synthetic.With(SyntheticSpace::Noise(18))});
  input.pairs.push_back({"drag", "fibres", 7, synthetic.With(SyntheticSpace::Noise(20)), false});
  input.failed_pairs = {{"drag", "gravity"}};
  input.nuisances.push_back({"clock", 2});
  input.natural_value["gravity"] = 1.5;
  input.baseline.hypotheses.front().selection_penalty = 0.7;
  input.adopted = {"jitter"};
  input.adopted_evidence = 20;
  input.in_place_of_adopted.push_back({"fibres", 25, synthetic.With(SyntheticSpace::Noise(19))});
  const TemporaryFolder folder;
  SaveDecisionInput(input, folder / "decision");
  const DecisionInput read = LoadDecisionInput(folder / "decision");
  EXPECT_EQ(read.failed_pairs, input.failed_pairs);
  const Decision before = Decide(input), after = Decide(read);
  EXPECT_EQ(after.verdict, before.verdict);
  EXPECT_EQ(after.names, before.names);
  ASSERT_EQ(after.record.probabilities.size(), before.record.probabilities.size());
  for (size_t k = 0; k < before.record.probabilities.size(); ++k)
    EXPECT_EQ(after.record.probabilities[k].probability,
              before.record.probabilities[k].probability);
  EXPECT_EQ(after.record.adequacy.p, before.record.adequacy.p);
  std::filesystem::remove(folder / "decision" / "products_1.npy");
  EXPECT_THROW(LoadDecisionInput(folder / "decision"), InputError);
}

}  // namespace
}  // namespace lacuna
