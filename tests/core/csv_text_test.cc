#include "core/csv_text.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(CsvText, QuotesWhatADelimiterOrAQuoteWouldCut) {
  EXPECT_EQ(CsvField("plain text"), "plain text");
  EXPECT_EQ(CsvField(""), "");
  EXPECT_EQ(CsvField("forces, y"), "\"forces, y\"");
  EXPECT_EQ(CsvField("said \"so\""), "\"said \"\"so\"\"\"");
  EXPECT_EQ(CsvField("a;b"), "\"a;b\"");
}

TEST(CsvText, AFormulaIsMadeAText) {
  EXPECT_EQ(CsvField("=1+1"), "\"'=1+1\"");
  EXPECT_EQ(CsvField("=HYPERLINK(\"http://x\",1)"), "\"'=HYPERLINK(\"\"http://x\"\",1)\"");
  EXPECT_EQ(CsvField("+cmd|' /C calc'!A0"), "\"'+cmd|' /C calc'!A0\"");
  EXPECT_EQ(CsvField("-2+3"), "\"'-2+3\"");
  EXPECT_EQ(CsvField("@SUM(A1)"), "\"'@SUM(A1)\"");
  EXPECT_EQ(CsvField("\t=1"), "\"'\t=1\"");
  EXPECT_EQ(CsvField("\r=1"), "\"'\r=1\"");
  EXPECT_EQ(CsvField("-"), "\"'-\"");
  EXPECT_EQ(VerbatimCsvField("=1,1"), "\"=1,1\"") << "for a reader of its own";
}

TEST(CsvText, ANumberStaysANumber) {
  for (const char* number : {"-0.25", "+3", "-1e-300", "-1e999", "-inf", "nan", "1.5"})
    EXPECT_EQ(CsvField(number), number);
}

}  // namespace
}  // namespace lacuna
