#include "core/json_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

std::vector<int> Numbers(const nlohmann::json& content) { return content.at("numbers"); }

TEST(ReadJsonFile, GivesWhatTheReaderMakesOfTheContent) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.json") << R"({"numbers": [3, 1], "also": 2})";
  EXPECT_THAT(ReadJsonFile(folder / "a.json", Numbers), ElementsAre(3, 1));
  EXPECT_EQ(ReadJsonFile(folder / "a.json").at("also"), 2);
  EXPECT_EQ(ReadJsonFile<nlohmann::ordered_json>(folder / "a.json").begin().key(), "numbers");
}

TEST(ReadJsonFile, SaysWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a.json";
  const auto read = [&] { ReadJsonFile(file, Numbers); };
  const auto says = [&](const char* problem) {
    return ThrowsMessage<InputError>(AllOf(StartsWith(file.string() + ": "), HasSubstr(problem)));
  };
  EXPECT_THAT(read, says("cannot be read: no such file, or no permission"));
  std::ofstream(file) << "{";
  EXPECT_THAT(read, says("is not JSON"));
  std::ofstream(file) << "{}";
  EXPECT_THAT(read, says("'numbers' not found"));
  std::ofstream(file) << R"({"numbers": "three"})";
  EXPECT_THAT(read, says("must be array"));

  const auto read_list = [&] { ReadJsonFile(file, Numbers, "a list of numbers"); };
  EXPECT_THAT(read_list, says("is not a list of numbers: "));
  std::ofstream(file) << "{";
  EXPECT_THAT(read_list, says("is not a list of numbers: "));
  std::filesystem::remove(file);
  EXPECT_THAT(read_list, says("cannot be read: no such file"));
}

}  // namespace
}  // namespace lacuna
