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
