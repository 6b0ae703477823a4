#include "paper/evaluation_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

TEST(EvaluationRecord, AnEvaluationIsFoundAgainAndAChangedOneIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "evaluations.jsonl";
  const SearchedParameters parameters{2, 1e-4, 1e6, 0.3};
  ObjectiveEvaluation evaluation;
  evaluation.usable = true;
  evaluation.residual_sum = 0.125;
  evaluation.seconds = 1.5;
  EvaluationRecord(file, "key").Append(parameters, evaluation);
  ASSERT_NE(EvaluationRecord(file, "key").Find(parameters), nullptr);
  EXPECT_EQ(EvaluationRecord(file, "key").Find(parameters)->residual_sum, 0.125);

  const std::string text = FileContent(file);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    const size_t at = other.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(file) << other.replace(at, from.size(), to);
  };
  changed("0.125", "0.126");
  EXPECT_THAT([&] { EvaluationRecord(file, "key"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("evaluations.jsonl:2"), HasSubstr("damaged; remove this file"))));
  changed("\"seconds\":1.5", "\"seconds\":2.5");  // a repeated run takes another time
  EXPECT_NE(EvaluationRecord(file, "key").Find(parameters), nullptr);
  // Files of earlier versions have no hashes.
  std::ofstream(file) << "{\"objective\":\"key\"}\n";
  EXPECT_EQ(EvaluationRecord(file, "key").Find(parameters), nullptr);
}

TEST(EvaluationRecord, OfAnotherObjectiveNamesTheFileToRemove) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "turn_3.jsonl";
  EvaluationRecord(file, "key");
  EXPECT_THAT(
      [&] { EvaluationRecord(file, "another key"); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("turn_3.jsonl:1: was made with other settings"),
                                      HasSubstr("remove this file"))));
  std::ofstream(file, std::ios::app) << "no JSON\n";
  EXPECT_THAT([&] { EvaluationRecord(file, "key"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("turn_3.jsonl:2: the line is damaged"), HasSubstr("remove"))));
}

TEST(EvaluationRecord, KnowsWhichEvaluationsComeFromOtherProcessors) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "evaluations.jsonl";
  EvaluationRecord(file, "key", "AVX2, Haswell").Append({2, 1e-4, 1e6, 0.3}, {});
  EXPECT_THAT(EvaluationRecord(file, "key", "AVX2, Haswell").other_instructions(), IsEmpty());
  EvaluationRecord other(file, "key", "AVX-512, SkylakeX");
  EXPECT_THAT(other.other_instructions(), ElementsAre("AVX2, Haswell"));
  EXPECT_NE(other.Find({2, 1e-4, 1e6, 0.3}), nullptr) << "it is used all the same";
  other.Append({2, 1e-4, 2e6, 0.3}, {});
  EXPECT_THAT(EvaluationRecord(file, "key", "AVX2, Haswell").other_instructions(),
              ElementsAre("AVX-512, SkylakeX"));
}

}  // namespace
}  // namespace lacuna
