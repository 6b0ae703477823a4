#include "record/verdict.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace lacuna {
namespace {

TEST(VerdictRecord, EveryVerdictIsReadBackFromItsName) {
  for (const Verdict verdict : {Verdict::kAdequate, Verdict::kMissing, Verdict::kAmbiguous,
                                Verdict::kNuisance, Verdict::kNotInLibrary, Verdict::kNoPower})
    EXPECT_EQ(VerdictFromName(VerdictName(verdict)), verdict);
  EXPECT_EQ(VerdictName(Verdict::kNotInLibrary), "not in library");
  EXPECT_THROW(VerdictFromName("guilty"), InputError);
}

TEST(VerdictRecord, EveryReasonAndStepIsReadBackAsItWasWritten) {
  Conclusion conclusion;
  conclusion.verdict = Verdict::kAmbiguous;
  conclusion.effects = {"drag", "mass_damping"};
  conclusion.reasons = {NothingDetectable{},
                        ErrorIsNoise{1e-4, 1.5},
                        ErrorUnexplained{1e-4, 2.5, 4},
                        NuisanceExplains{2, 0.5},
                        ResidualRemains{"drag", 0.75, 1.5},
                        EvidenceForAnother{"drag", 300, "gravity", 16},
                        EffectReducesError{"drag", 300, false, true, 5, 1}};
  ASSERT_EQ(conclusion.reasons.size(), std::variant_size_v<VerdictReason>);
  conclusion.next_steps = {AddAndDiagnose{"drag", "gravity"}, SeparateLookAlikes{"drag"},
                           CheckNuisance{2}};
  ASSERT_EQ(conclusion.next_steps.size(), std::variant_size_v<SuggestedStep>);
  const nlohmann::json written = ConclusionToJson(conclusion);
  const Conclusion read = ConclusionFromJson(written);
  EXPECT_EQ(read.verdict, Verdict::kAmbiguous);
  EXPECT_EQ(read.effects, conclusion.effects);
  ASSERT_EQ(read.reasons.size(), conclusion.reasons.size());
  for (size_t k = 0; k < read.reasons.size(); ++k)
    EXPECT_EQ(read.reasons[k].index(), conclusion.reasons[k].index());
  // Every field is written and read: the second writing equals the first.
  EXPECT_EQ(ConclusionToJson(read), written);
}

TEST(VerdictRecord, AnUnknownKindOfReasonIsRefused) {
  nlohmann::json written = ConclusionToJson({});
  written["reasons"] = {{{"kind", "hunch"}}};
  EXPECT_THROW(ConclusionFromJson(written), InputError);
}

}  // namespace
}  // namespace lacuna
