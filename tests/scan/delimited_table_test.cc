#include "scan/delimited_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scan/column_units.h"
#include "scan/table_numbers.h"
#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

DelimitedTable Table(const std::string& content) {
  const TestFolder folder;
  return ReadDelimitedTable(folder.Write("t.csv", content));
}

TEST(DelimitedTable, AByteOrderMarkIsNoPartOfAName) {
  const DelimitedTable table = Table("\xef\xbb\xbfx,y,z\r\n1,2,3\r\n");
  EXPECT_THAT(table.header, ElementsAre("x", "y", "z"));
  EXPECT_EQ(table.values(0, 2), 3);
}

TEST(DelimitedTable, ReadsDecimalCommasWhereAnotherDelimiterIsUsed) {
  for (const char* content : {"x;y;z\n1,5;-2,25;3\n", "x\ty\tz\n1,5\t-2,25\t3\n", "1,5;-2,25;3\n",
                              "1,5\t-2,25\t3\n", "1,5 -2,25 3\n", "x y z\n1,5 -2,25 3\n",
                              "\"1,5\",\"-2,25\",\"3\"\n", "x,y,z\n\"1,5\",\"-2,25\",3\n"}) {
    const DelimitedTable table = Table(content);
    ASSERT_EQ(table.values.rows(), 1) << content;
    ASSERT_EQ(table.values.cols(), 3) << content;
    EXPECT_EQ(table.values.row(0), Eigen::RowVector3d(1.5, -2.25, 3)) << content;
  }
}

TEST(DelimitedTable, ANameInQuotesMayHoldDelimitersAndQuotes) {
  const DelimitedTable table = Table("t,\"a;b,c\",\"said \"\"so, so\"\"\",\"\"\"\"\n0,1,2,3\n");
  EXPECT_THAT(table.header, ElementsAre("t", "a;b,c", "said \"so, so\"", "\""));
  EXPECT_EQ(table.values(0, 3), 3);
  EXPECT_THAT(Table("t;\"a,b\"\n0;1,5\n").header, ElementsAre("t", "a,b"));
  EXPECT_EQ(Table("t,\"\"\"\"\"\"\n0,1\n").header[1], "\"\"") << "each two stand for one";
  EXPECT_EQ(Table("\"1,5\"\n\"2,5\"\n").values(1, 0), 2.5) << "all in quotes";
}

// Where each pair is removed from the whole name, this takes minutes.
TEST(DelimitedTable, ANameOfAMillionQuotesIsReadAtOnce) {
  const DelimitedTable table = Table("t,\"" + std::string(2'000'000, '"') + "\"\n0,1\n");
  EXPECT_EQ(table.header[1].size(), 1'000'000u);
}

TEST(DelimitedTable, NamesDecimalCommasThatCannotBeTold) {
  EXPECT_THAT(ErrorOf([] { Table("x,y,z\n1,5,2,5,3,5\n"); }),
              HasSubstr("t.csv:2:1: has 6 entries where the first line has 3; decimal commas need "
                        "another delimiter"));
  EXPECT_THAT(ErrorOf([] { Table("x;y\n1.234,5;2\n"); }), HasSubstr("got \"1.234,5\""));
}

TEST(DelimitedTable, FindsAColumnWhoseNameDiffersInCase) {
  const DelimitedTable table = Table("X,Y,y\n1,2,3\n");
  EXPECT_EQ(FindColumn(table, "x"), 0);
  EXPECT_EQ(FindColumn(table, "y"), 2);
  EXPECT_EQ(FindColumn(table, "z"), std::nullopt);
}

TEST(DelimitedTable, RefusesANameThatSeveralColumnsHave) {
  const DelimitedTable table = Table("t,F,F\n1,2,3\n");
  EXPECT_THAT(ErrorOf([&] { RequireColumn(table, "F"); }),
              HasSubstr("t.csv: has 2 columns \"F\", of which the numbers are 2 and 3"));
  EXPECT_EQ(RequireColumn(table, "3"), 2);
  EXPECT_EQ(RequireColumn(table, "t"), 0);
  EXPECT_THAT(ErrorOf([&] { FindColumn(table, "f"); }), HasSubstr("has 2 columns \"f\""));
}

TEST(DelimitedTable, RefusesCommasThatMaySeparateThousands) {
  EXPECT_THAT(ErrorOf([] { Table("t,F\n0.1,\"999.5\"\n0.2,\"-1,005\"\n"); }),
              HasSubstr("t.csv:3:6: got \"-1,005\", which is -1005 with a thousands separator "
                        "and -1.005 with a decimal comma"));
  EXPECT_THAT(ErrorOf([] { Table("t,F\n1,\"1,005\"\n2,\"1,006\"\n"); }), HasSubstr("is 1005 with"))
      << "nothing decides";
  EXPECT_THAT(ErrorOf([] { Table("t;F\n0.5;1,005\n"); }), HasSubstr("is 1005 with"));
  for (const char* content : {"t,F\n1,\"1,005\"\n2,\"1,5\"\n", "t;F\n1;1,005\n2;1,006\n",
                              "t,F\n1,\"1,005\"\n2,\"0,500\"\n"})
    EXPECT_EQ(Table(content).values(0, 1), 1.005) << content;
}

TEST(DelimitedTable, SkipsEmptyRowsAtItsEndOnly) {
  const DelimitedTable table = Table("x,y\n1,2\n,\n3,4\n,\n,\n,,\n");
  ASSERT_EQ(table.values.rows(), 3);
  EXPECT_TRUE(table.values.row(1).array().isNaN().all());
  EXPECT_EQ(table.values.row(2), Eigen::RowVector2d(3, 4));
  EXPECT_THAT(table.line, ElementsAre(2, 3, 4));
  EXPECT_THAT(ErrorOf([] { Table("x,y\n1,2\n,,\n3,4\n"); }), HasSubstr("t.csv:3:1: has 3 entries"));
}

TEST(DelimitedTable, TakesTheDelimiterThatItsFirstLineDeclares) {
  for (const char* content : {"sep=;\nx;y\n1,5;2\n", "\"sep=;\"\r\nx;y\r\n1,5;2\r\n",
                              "sep=\t\nx\ty\n1.5\t2\n", "sep=;\n1,5;2\n"}) {
    const DelimitedTable table = Table(content);
    ASSERT_EQ(table.values.rows(), 1) << content;
    EXPECT_EQ(table.values.row(0), Eigen::RowVector2d(1.5, 2)) << content;
  }
}

TEST(DelimitedTable, TabsMayDivideNamesWithOtherDelimiters) {
  const DelimitedTable table = Table("Time, s\tForce, N\n0,01\t1,5\n");
  EXPECT_THAT(table.header, ElementsAre("Time, s", "Force, N"));
  EXPECT_EQ(table.values.row(0), Eigen::RowVector2d(0.01, 1.5));
  EXPECT_THAT(Table("run 7\nTime; s\tx\n1\t2\n").header, ElementsAre("Time; s", "x"));
  EXPECT_THAT(Table("x,\ty,\tz\n1,\t2,\t3\n").header, ElementsAre("x", "y", "z"));
}

TEST(DelimitedTable, DoubtsAFirstLineOfNumbers) {
  EXPECT_THAT(
      Table("0.5,1.25,lost\n1,2,3\n").notes,
      ElementsAre(HasSubstr("t.csv:1: the first line was taken for the names of the columns "
                            "because of \"lost\", but 2 of its 3 entries are numbers")));
  EXPECT_THAT(Table("0,1,2\n1.5,2.5,3.5\n1.5,2.5,3.25\n").notes,
              ElementsAre(HasSubstr("the first line, 0, 1, 2, was read as a row of data")));
  EXPECT_THAT(Table("t,1,2,3\n0.1,2,3,4\n").notes, IsEmpty()) << "numbers of channels";
  EXPECT_THAT(Table("0,1,2\n3,4,5\n6,7,8\n").notes, IsEmpty()) << "a table of whole numbers";
  EXPECT_THAT(Table("0.5,1,2\n1.5,2.5,3.5\n1.5,2.5,3.25\n").notes, IsEmpty());
}

TEST(DelimitedTable, TakesALineOfUnitsBelowTheNames) {
  for (const char* content : {"\"Time\",\"Load\"\n\"(s)\",\"(N)\"\n\"0.5\",\"2\"\n",
                              "Time;Load\ns;N\n0,5;2\n", "Time,Load\n[s],[N]\n0.5,2\n"}) {
    const DelimitedTable table = Table(content);
    EXPECT_THAT(table.header, ElementsAre("Time", "Load")) << content;
    EXPECT_THAT(table.units, ElementsAre("s", "N")) << content;
    EXPECT_EQ(table.values.row(0), Eigen::RowVector2d(0.5, 2)) << content;
    EXPECT_EQ(UnitOfColumn(table, 1), "N");
  }
  EXPECT_THAT(ErrorOf([] { Table("Time,Load\nnow,here\n1,2\n"); }), HasSubstr("got \"now\""));
}

TEST(DelimitedTable, JoinsTheNamesOfGroupsAndOfTheirColumns) {
  const DelimitedTable pandas = Table("time,m0,,,m1,,\n,x,y,z,x,y,z\n0,1,2,3,4,5,6\n");
  EXPECT_THAT(pandas.header, ElementsAre("time", "m0_x", "m0_y", "m0_z", "m1_x", "m1_y", "m1_z"));
  const DelimitedTable vicon =
      Table("Trajectories\n100\n,,Bar:m0,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,7,8,9\n");
  EXPECT_THAT(vicon.header, ElementsAre("Frame", "Sub Frame", "Bar:m0_X", "Bar:m0_Y", "Bar:m0_Z"));
  EXPECT_EQ(UnitOfColumn(vicon, 2), "mm");
  EXPECT_THAT(vicon.line, ElementsAre(6));
  EXPECT_EQ(vicon.values(0, 4), 9);
}

TEST(DelimitedTable, SkipsTheNumberOfPointsAndTheMarkOfTheirNames) {
  EXPECT_EQ(Table("2\n1 2 3\n4 5 6\n").values.rows(), 2);
  const DelimitedTable cloud = Table("//X Y Z\n2\n1 2 3\n4 5 6\n");
  EXPECT_THAT(cloud.header, ElementsAre("X", "Y", "Z"));
  EXPECT_EQ(cloud.values.rows(), 2);
  EXPECT_EQ(Table("5\n6\n").values.rows(), 2) << "a column of numbers";
}

TEST(DelimitedTable, ReadsWordsForMissingValues) {
  for (const char* word : {"", "nan", "-nan(ind)", "NULL", "None", "NA", "#N/A", "-", "1.#QNAN"}) {
    const DelimitedTable table = Table("t,x\n0,1\n1," + std::string(word) + "\n");
    EXPECT_TRUE(std::isnan(table.values(1, 1))) << word;
  }
  EXPECT_THAT(ErrorOf([] { Table("t,x\n0,1\n1,lost\n"); }), HasSubstr("got \"lost\""));
}

TEST(DelimitedTable, RefusesASummaryBelowItsLastRow) {
  const auto error = [](const std::string& below) {
    return ErrorOf([&] { Table("t,x,y\n0,1,2\n1,3,4\n" + below); });
  };
  const auto refused = [](const std::string& word) {
    return HasSubstr("t.csv:4:1: is not a row of numbers (got \"" + word +
                     "\"); remove summary lines at the end of the table");
  };
  EXPECT_THAT(error("Mean, 1.2, 3.4\n"), refused("Mean"));
  EXPECT_THAT(error("Mean,1.2\nDeviation,0.3\n\n"), refused("Mean")) << "of another width";
  EXPECT_THAT(error(",Mean,1.2"), refused("Mean"));
  EXPECT_THAT(error("End of file\n,,\n"), refused("End of file"));
  EXPECT_THAT(error("lost,1,2\n2,5,6\n"), HasSubstr("t.csv:4:1: got \"lost\"; expected a number"));
  EXPECT_THAT(error("1.000,5,1,2\n"), HasSubstr("has 4 entries")) << "no word";
  EXPECT_THAT(error("2,lost,6\n"), HasSubstr("t.csv:4:3: got \"lost\"; expected a number"));
}

TEST(DelimitedTable, SkipsCommentsAndEmptyLinesBelowItsLastRow) {
  const DelimitedTable table = Table("t,x\n0,1\n1,3\n\n# Mean, 2\n  \n#end\n");
  ASSERT_EQ(table.values.rows(), 2);
  EXPECT_EQ(table.values.row(1), Eigen::RowVector2d(1, 3));
}

TEST(DelimitedTable, SaysThatDatesAreNotRead) {
  EXPECT_THAT(
      ErrorOf([] { Table("t,x\n2024-05-01 12:00:00.0,1\n"); }),
      HasSubstr("expected a number, such as seconds since the first row: dates and times of "
                "day are not read"));
}

}  // namespace
}  // namespace lacuna
