#include "report/ledger_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/small_ledger.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(LedgerReport, DrawsTheModelsAndWhatWasTriedAsATree) {
  const std::string text = LedgerReport(SmallLedger());
  EXPECT_THAT(text, HasSubstr("├── tried  mass_damping"));
  EXPECT_THAT(text, Not(HasSubstr("tried  drag")));
  EXPECT_THAT(text, HasSubstr("└── added  drag"));
  EXPECT_THAT(text, HasSubstr("50 % less than before"));
  EXPECT_THAT(text, HasSubstr("b (not fitted)"));
  EXPECT_THAT(text, HasSubstr("held-out error before   0.400 mm, 4.0 σ\n"
                              "what was added          drag\n"
                              "held-out error after    0.200 mm, 2.0 σ\n"));
}

TEST(LedgerReport, SaysWhyAModelIsNotUsable) {
  Ledger ledger = SmallLedger();
  CalibrationRecord failed;
  failed.message = "no convergence";
  ledger.models.push_back(
      MakeLedgerModel(ledger, "/runs/bar+drag+swelling", failed, 1, "swelling"));
  EXPECT_THAT(LedgerReport(ledger), HasSubstr("the fit is not usable: no convergence"));
  ledger.ending.reason = LedgerEnding::Reason::kNotFitted;
  EXPECT_EQ(DescribeEnding(ledger),
            "The search ended because swelling cannot be fitted: no convergence.");
}

// Once swelling is added, too, nothing is left for the drag.
TEST(LedgerReport, SaysWhichAddedEffectMayBeLeftOut) {
  Ledger ledger = SmallLedger();
  ledger.models.front().diagnosis->ranking.front().sizes = {{"coefficient", "Pa"}};
  const CalibrationRecord& with_drag = ledger.models.back().record;
  CalibrationRecord with_both = with_drag;
  for (FittedRecording& recording : with_both.recordings)
    for (MisfitMeasure* measure : {&recording.in_fit, &recording.held_out}) {
      measure->rms *= 0.5;
      measure->rms_over_sigma *= 0.5;
    }
  for (const double low : {-0.1, 0.1}) {
    with_both.parameters.back().estimate.low = low;
    with_both.parameters.back().estimate.high = 0.3;
    Ledger extended = ledger;
    extended.models.push_back(
        MakeLedgerModel(extended, "/runs/bar+drag+swelling", with_both, 1, "swelling"));
    const std::string text = LedgerSummary(extended);
    EXPECT_THAT(text, HasSubstr("what was added          drag, swelling\n"));
    const auto told = HasSubstr("what may be left out    drag, whose size may be zero");
    if (low < 0)
      EXPECT_THAT(text, told);
    else
      EXPECT_THAT(text, Not(told));
  }
}

TEST(LedgerReport, SaysWhyTheSearchEnded) {
  Ledger ledger = SmallLedger();
  EXPECT_EQ(DescribeEnding(ledger),
            "The search ended because drag reduces the held-out error by 50.0 %, less than 60 %.");
  ledger.models.back().diagnosis.emplace();
  ledger.models.back().diagnosis->verdict = Verdict::kNotInLibrary;
  ledger.ending.reason = LedgerEnding::Reason::kVerdict;
  EXPECT_EQ(DescribeEnding(ledger), "The search ended with the verdict \"not in library\".");
  ledger.models.back().diagnosis->effects = {"swelling", "gravity"};
  ledger.ending.reason = LedgerEnding::Reason::kUndecided;
  EXPECT_THAT(DescribeEnding(ledger),
              StartsWith("The search ended undecided between {swelling, gravity}"));
  ledger.ending.reason = LedgerEnding::Reason::kMostEffects;
  EXPECT_EQ(DescribeEnding(ledger),
            "The search ended after 1 added effects, although swelling is still named.");
  ledger.ending.reason = LedgerEnding::Reason::kNone;
  EXPECT_EQ(DescribeEnding(ledger), "");
}

}  // namespace
}  // namespace lacuna
