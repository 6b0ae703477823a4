#include "core/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(ReadWholeFile, KeepsEveryByte) {
  const TemporaryFolder folder;
  const std::string content("a\r\n\0\xff no end of line", 20);
  WriteFileAtomically(folder / "file", content);
  EXPECT_EQ(ReadWholeFile(folder / "file"), content);
  WriteFileAtomically(folder / "file", "");
  EXPECT_EQ(ReadWholeFile(folder / "file"), "");
}

TEST(ReadWholeFile, ErrorNamesTheUnreadableFile) {
  const TemporaryFolder folder;
  for (const std::filesystem::path& file : {folder / "absent", folder / "."}) {
    try {
      ReadWholeFile(file);
      ADD_FAILURE() << file << " was read";
    } catch (const InputError& problem) {
      EXPECT_EQ(std::string(problem.what()), file.string() + ": cannot be opened for reading");
    }
  }
}

}  // namespace
}  // namespace lacuna
