#include "diagnosis/decision_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>

#include "core/error.h"
#include "diagnosis/decision.h"
#include "diagnosis/synthetic_space.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

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
  WriteDecisionInput(input, folder / "decision");
  const DecisionInput read = ReadDecisionInput(folder / "decision");
  EXPECT_EQ(read.failed_pairs, input.failed_pairs);
  const Decision before = Decide(input), after = Decide(read);
  EXPECT_EQ(after.verdict, before.verdict);
  EXPECT_EQ(after.names, before.names);
  ASSERT_EQ(after.record.probabilities.size(), before.record.probabilities.size());
  for (size_t k = 0; k < before.record.probabilities.size(); ++k)
    EXPECT_EQ(after.record.probabilities[k].probability,
              before.record.probabilities[k].probability);
  EXPECT_EQ(after.record.adequacy.p, before.record.adequacy.p);
}

std::set<std::filesystem::path> MatricesIn(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".npy") files.insert(entry.path());
  return files;
}

// The input of a decision with one refit, made of this noise.
DecisionInput InputWithRefit(uint64_t seed) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(seed) - 9 * synthetic.Of("drag"));
  input.refits.push_back({"drag", 30, synthetic.With(SyntheticSpace::Noise(seed))});
  return input;
}

// A matrix that another decision has left is of the same size.
TEST(DecisionStore, RefusesAMatrixThatIsMissingOrOfAnotherDecision) {
  const TemporaryFolder folder;
  WriteDecisionInput(InputWithRefit(18), folder / "one");
  WriteDecisionInput(InputWithRefit(19), folder / "other");
  const std::filesystem::path own = *MatricesIn(folder / "one").begin();
  std::filesystem::copy_file(*MatricesIn(folder / "other").begin(), own,
                             std::filesystem::copy_options::overwrite_existing);
  const auto read = [&] { ReadDecisionInput(folder / "one"); };
  EXPECT_THAT(read, ThrowsMessage<InputError>(
                        AllOf(HasSubstr(own.string()), HasSubstr("run `lacuna diagnose` again"))));
  std::filesystem::remove(own);
  EXPECT_THAT(read, ThrowsMessage<InputError>(HasSubstr(own.string())));
}

// A writer that is killed before it replaces decision.json leaves new matrices beside the old ones.
TEST(DecisionStore, KeepsTheDecisionBeforeUntilTheNewOneIsComplete) {
  const TemporaryFolder folder;
  const DecisionInput before = InputWithRefit(18), after = InputWithRefit(19);
  WriteDecisionInput(before, folder / "kept");
  const std::set<std::filesystem::path> of_before = MatricesIn(folder / "kept");
  WriteDecisionInput(after, folder / "other");
  for (const std::filesystem::path& file : MatricesIn(folder / "other"))
    std::filesystem::copy_file(file, folder / "kept" / file.filename());
  EXPECT_EQ(ReadDecisionInput(folder / "kept").baseline.model.squares(),
            before.baseline.model.squares());
  // Once it is complete, the old matrices are gone, those of earlier versions included.
  std::filesystem::copy_file(*of_before.begin(), folder / "kept" / "products_0.npy");
  WriteDecisionInput(after, folder / "kept");
  EXPECT_EQ(ReadDecisionInput(folder / "kept").baseline.model.squares(),
            after.baseline.model.squares());
  EXPECT_EQ(MatricesIn(folder / "kept").size(), 2u);
  for (const std::filesystem::path& file : of_before) EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(DecisionStore, AsksForANewDiagnosisWhereTheFormatIsOld) {
  const TemporaryFolder folder;
  std::ofstream(folder / "decision.json") << R"({"schema_version": 6, "baseline": {}})";
  EXPECT_THAT([&] { ReadDecisionInput(folder.Path()); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("format 6"), HasSubstr("run `lacuna diagnose` again"))));
}

}  // namespace
}  // namespace lacuna
