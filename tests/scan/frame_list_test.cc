#include "scan/frame_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

TEST(FrameList, FillsPatternsAsPrintfDoes) {
  EXPECT_EQ(FillPattern("a_%02d.csv", 7), "a_07.csv");
  EXPECT_EQ(FillPattern("a_%d.csv", 7), "a_7.csv");
  EXPECT_EQ(FillPattern("%03d/b", 1234), "1234/b");
  EXPECT_THROW(FillPattern("a.csv", 1), std::invalid_argument);
  EXPECT_THROW(FillPattern("a_%s.csv", 1), std::invalid_argument);
  EXPECT_THROW(FillPattern("a_%d_%d.csv", 1), std::invalid_argument);
}

TEST(FrameList, ComparesNumbersInNamesAsNumbers) {
  // Each list is in the order that is expected.
  const std::vector<std::vector<std::string>> lists = {
      {"scan_9.ply", "scan_10.ply"},
      {"a2/scan_10.ply", "a10/scan_9.ply"},
      {"scan_009.ply", "scan_10.ply"},
      {"s_0.off", "s_0.25.off", "s_0.5.off", "s_1.off", "s_1.125.off", "s_10.0.off"},
      {"s_000.25.off", "s_000.5.off", "s_001.125.off"},
      {"s_1.2.off", "s_1.9.off", "s_1.10.off", "s_1.11.off"}};
  for (const std::vector<std::string>& sorted : lists) {
    std::vector<std::string> names(sorted.rbegin(), sorted.rend());
    SortNaturally(&names);
    EXPECT_EQ(names, sorted);
  }
}

TEST(FrameList, FindsTheNumberMissingFromASequence) {
  EXPECT_EQ(FindMissingNumber({"f_1.ply", "f_2.ply", "f_4.ply"}), 3);
  EXPECT_EQ(FindMissingNumber({"f_0.ply", "f_10.ply", "f_20.ply", "f_40.ply"}), 30);
  EXPECT_EQ(FindMissingNumber({"f_0.ply", "f_10.ply", "f_20.ply"}), std::nullopt);
  EXPECT_EQ(FindMissingNumber({"a.ply", "b.ply", "d.ply"}), std::nullopt);
  EXPECT_EQ(FindMissingNumber({"v1/f_1.ply", "v1/f_2.ply", "v1/f_4.ply"}), 3);
  // Times at which the frames were taken.
  EXPECT_EQ(FindMissingNumber({"c_1000.ply", "c_1033.ply", "c_1067.ply", "c_1100.ply"}),
            std::nullopt);
  EXPECT_EQ(FindMissingNumber({"f_1.ply", "f_2.ply", "f_5.ply", "f_9.ply"}), std::nullopt);
}

std::vector<std::filesystem::path> ReadFrom(const TestFolder& folder, const std::string& yaml) {
  const Config config = Config::Parse(yaml, "recording.yaml");
  const auto files = ReadFrameFiles(config, folder.Path());
  config.RefuseUnknownKeys();
  return files;
}

TEST(FrameList, FindsFilesByPatternListAndWildcard) {
  const TestFolder folder;
  for (const int i : {8, 9, 10, 11}) folder.Write("f/s" + std::to_string(i) + ".xyz", "1 2 3\n");
  const std::filesystem::path first = folder.Path() / "f/s8.xyz",
                              last = folder.Path() / "f/s11.xyz";
  for (const std::string yaml : {"{pattern: f/s%d.xyz, first: 8, count: 4}", "files: f/s*.xyz",
                                 "files: [f/s8.xyz, f/s9.xyz, f/s10.xyz, f/s11.xyz]"}) {
    const auto files = ReadFrom(folder, yaml);
    ASSERT_EQ(files.size(), 4u) << yaml;
    EXPECT_EQ(files.front(), first);
    EXPECT_EQ(files.back(), last);
  }
}

TEST(FrameList, ReportsMissingFrames) {
  const TestFolder folder;
  for (const int i : {1, 2, 4}) folder.Write("s" + std::to_string(i) + ".xyz", "1 2 3\n");
  const auto message = [&](const std::string& yaml) {
    return ErrorOf([&] { ReadFrom(folder, yaml); });
  };
  EXPECT_THAT(message("{pattern: s%d.xyz, first: 1, count: 4}"),
              HasSubstr("pattern: frame 2: there is no file"));
  EXPECT_THAT(message("files: [s1.xyz, s3.xyz]"), HasSubstr("files: frame 1: there is no file"));
  EXPECT_THAT(message("files: s*.xyz"), HasSubstr("the frame numbered 3 is missing"));
  EXPECT_THAT(message("files: t*.xyz"), HasSubstr("no file matches"));
  EXPECT_THAT(message("first: 1"), HasSubstr("expected either files"));
  EXPECT_THAT(message("{files: [s1.xyz], pattern: s%d.xyz, count: 1}"),
              HasSubstr("expected either files"));
  EXPECT_THAT(message("{pattern: s.xyz, count: 1}"),
              HasSubstr("expected one placeholder for the number"));
}

TEST(FrameList, TakesTheNamesOfFoldersLiterally) {
  const TestFolder folder;
  for (const std::string name : {"100% [a]*b?", "[1-3]", "back\\slash"}) {
    for (const int i : {1, 2}) folder.Write(name + "/s" + std::to_string(i) + ".xyz", "1 2 3\n");
    const Config config = Config::Parse("files: s*.xyz", "recording.yaml");
    const auto files = ReadFrameFiles(config, folder.Path() / name);
    ASSERT_EQ(files.size(), 2u) << name;
    EXPECT_EQ(files[0], folder.Path() / name / "s1.xyz");
  }
  EXPECT_EQ(ReadFrom(folder, "{pattern: '100% [a]*b?/s%d.xyz', first: 1, count: 2}").size(), 2u);
  EXPECT_EQ(ReadFrom(folder, "files: '[1-3]/s*.xyz'").size(), 2u);
}

}  // namespace
}  // namespace lacuna
