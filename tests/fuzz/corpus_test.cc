// The files from which the fuzzers start, and those that have made a reader fail once.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include "fuzz/readers.h"

namespace lacuna {
namespace {

class Corpus : public testing::TestWithParam<FuzzedReader> {};

// Files whose name begins with "bad" are refused, with a message that names the file; all others
// are read.
TEST_P(Corpus, IsReadOrRefusedAsItsNamesSay) {
  const std::filesystem::path folder =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  EXPECT_FALSE(files.empty());
  int good = 0;
  for (const std::filesystem::path& file : files) {
    const std::string message = ReadWith(GetParam(), file);
    if (file.filename().string().rfind("bad", 0) == 0) {
      EXPECT_NE(message.find(file.filename().string()), std::string::npos)
          << file << ": " << (message.empty() ? "is read" : message);
    } else {
      EXPECT_EQ(message, "") << file;
      ++good;
    }
  }
  EXPECT_GT(good, 0);
}

INSTANTIATE_TEST_SUITE_P(EachReader, Corpus, testing::ValuesIn(FuzzedReaders()),
                         [](const auto& reader) { return reader.param.name; });

}  // namespace
}  // namespace lacuna
