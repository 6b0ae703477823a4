#include "record/csv_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(CsvTableTest, NumbersAreReadBackExactlyAndNanStaysNan) {
  const TemporaryFolder folder;
  const Eigen::Vector3d values(0.1, 1e-310, -std::numeric_limits<double>::max());
  const Eigen::Vector3d others(std::nan(""), 1.0 / 3, std::numeric_limits<double>::infinity());
  WriteCsv({{"time_s", values}, {"residual_m", others}}, folder / "a.csv");
  const CsvTable table = ReadCsv(folder / "a.csv");
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[0].name, "time_s");
  EXPECT_EQ(table[1].name, "residual_m");
  EXPECT_EQ(table[0].values, values);
  EXPECT_TRUE(std::isnan(table[1].values[0]));
  EXPECT_EQ(table[1].values.tail(2), others.tail(2));
}

TEST(CsvTableTest, TextHasTheFormThatSpreadsheetsExpect) {
  const TemporaryFolder folder;
  WriteCsv({{"a", Eigen::Vector2d(1, 0.5)}, {"b", Eigen::Vector2d(-2, 1e20)}}, folder / "a.csv");
  EXPECT_EQ(FileContent(folder / "a.csv"), "a,b\n1,-2\n0.5,1e+20\n");
}

TEST(CsvTableTest, TableWithoutRowsKeepsItsHeader) {
  const TemporaryFolder folder;
  WriteCsv({{"a", Eigen::VectorXd(0)}}, folder / "a.csv");
  const CsvTable table = ReadCsv(folder / "a.csv");
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table[0].values.size(), 0);
}

TEST(CsvTableTest, AColumnIsFoundByItsName) {
  const CsvTable table = {{"a", Eigen::Vector2d(1, 2)}, {"b", Eigen::Vector2d(3, 4)}};
  EXPECT_EQ(ColumnOf(table, "b", "x.csv"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(FindColumn(table, "c"), nullptr);
  EXPECT_THAT([&] { ColumnOf(table, "c", "x.csv"); },
              ThrowsMessage<InputError>(HasSubstr("x.csv: has no column c")));
}

TEST(CsvTableTest, ErrorsInDamagedFilesNameTheLine) {
  const TemporaryFolder folder;
  const auto file = folder / "a.csv";
  const auto expect = [&](const std::string& text, const std::string& cause) {
    std::ofstream(file) << text;
    EXPECT_THAT([&] { ReadCsv(file); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr(cause))));
  };
  expect("a,b\n1,2\n3\n", ":3: has 1 fields; the header names 2");
  expect("a,b\n1,2x\n", ":2: b: got '2x'; expected a number");
  expect("a,b\n1,\n", ":2: b: got ''");
  expect("", "is empty");
  EXPECT_THAT([&] { ReadCsv(folder / "absent.csv"); },
              ThrowsMessage<InputError>(HasSubstr("no such file")));
}

TEST(CsvTableDeathTest, UnequalLengthsAndAmbiguousNamesAreRefused) {
  const TemporaryFolder folder;
  const Eigen::VectorXd two = Eigen::Vector2d(1, 2);
  const Eigen::VectorXd three = Eigen::Vector3d(1, 2, 3);
  EXPECT_DEATH(WriteCsv({{"a", two}, {"b", three}}, folder / "a.csv"),
               "column b has another length");
  EXPECT_DEATH(WriteCsv({{"a", two}, {"a", two}}, folder / "a.csv"), "two columns named a");
  EXPECT_DEATH(WriteCsv({{"a,b", two}}, folder / "a.csv"), "cannot name a column");
}

}  // namespace
}  // namespace lacuna
