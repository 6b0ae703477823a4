#include "report/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support/small_ledger.h"
#include "support/small_run.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr char kSmallTemplate[] =
    "<!doctype html>\n<script type=\"application/json\" id=\"report-data\">{}</script>\n<p>";

// What stands between the tags of the data's element.
std::string DataOf(const std::string& page) {
  const std::string open = "id=\"report-data\">";
  const size_t begin = page.find(open) + open.size();
  return page.substr(begin, page.find("</script>", begin) - begin);
}

TEST(ReportPage, HoldsTheDocumentInThePlaceOfThePlaceholder) {
  const nlohmann::json document = {{"title", "bar"}, {"values", {1.5, nullptr}}};
  const std::string page = ReportPage(kSmallTemplate, document);
  EXPECT_EQ(nlohmann::json::parse(DataOf(page)), document);
  EXPECT_THAT(page, HasSubstr("<!doctype html>"));
  EXPECT_TRUE(page.ends_with("</script>\n<p>"));
}

TEST(ReportPage, HostileNamesStayText) {
  const std::vector<std::string> names{
      "</script><script>alert(1)</script>", "<!--<script>", "\" onload=\"x",
      "line\u2028separator\u2029",          "σ ≤ 3",        std::string(10000, '<')};
  const std::string page = ReportPage(kSmallTemplate, {{"names", names}});
  const std::string data = DataOf(page);
  EXPECT_THAT(data, Not(HasSubstr("<")));
  EXPECT_TRUE(std::all_of(data.begin(), data.end(), [](char c) { return c >= 32 && c < 127; }));
  EXPECT_EQ(nlohmann::json::parse(data).at("names"), nlohmann::json(names));
}

TEST(ReportPage, BytesThatAreNotUtf8AreReplaced) {
  const std::string data = DataOf(ReportPage(kSmallTemplate, {{"name", "caf\xe9"}}));
  EXPECT_EQ(nlohmann::json::parse(data).at("name"), "caf\uFFFD");
}

TEST(ReportPage, NeedsExactlyOnePlaceholder) {
  EXPECT_THROW(ReportPage("<p>", {}), InputError);
  EXPECT_THROW(ReportPage(std::string(kSmallTemplate) + kSmallTemplate, {}), InputError);
}

TEST(ReportPage, TheBuiltInTemplateHasThePlaceholder) {
  EXPECT_THAT(ReportPage(ReportTemplate(), {{"title", "found"}}), HasSubstr("\"title\":\"found\""));
}

TEST(ReportPage, TheSameRunGivesTheSameBytes) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const ReportFiles files = DefaultReportFiles({folder / "bar"});
  EXPECT_EQ(files.page, folder / "bar/report.html");
  WriteReport({folder / "bar"}, files);
  const std::string page = FileContent(files.page), numbers = FileContent(files.numbers);
  WriteReport({folder / "bar"}, files);
  EXPECT_EQ(FileContent(files.page), page);
  EXPECT_EQ(FileContent(files.numbers), numbers);
  // Nor does it depend on where the command was given.
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.Path());
  WriteReport({"bar"}, files);
  std::filesystem::current_path(before);
  EXPECT_EQ(FileContent(files.page), page);
  EXPECT_FALSE(nlohmann::json::parse(numbers).at("sentences").empty());
}

TEST(ReportPage, SeveralRunsHaveAFileBesideTheFirst) {
  EXPECT_EQ(DefaultReportFiles({"results/a", "results/b/"}).page, "results/a_vs_b.html");
  EXPECT_THROW(DefaultReportFiles({std::string(150, 'a'), std::string(150, 'b')}), InputError);
}

// A file in which a recording's name or a marker's name tries to leave its element.
TEST(ReportPage, AHostileMarkerNameInARunStaysText) {
  const TemporaryFolder folder;
  const SmallRun run{.marker = "</script><img src=x onerror=alert(1)>"};
  WriteSmallFit(folder / "bar", run, SmallLedger().models[0].record);
  WriteSmallComparison(folder / "bar", run);
  const ReportFiles files = DefaultReportFiles({folder / "bar"});
  WriteReport({folder / "bar"}, files);
  EXPECT_THAT(FileContent(files.page), Not(HasSubstr("<img src=x")));
  EXPECT_THAT(FileContent(files.numbers), HasSubstr("<img src=x"));
}

}  // namespace
}  // namespace lacuna
