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
  const auto message = [](const std::filesystem::path& file) -> std::string {
    try {
      ReadWholeFile(file);
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "it was read";
  };
  EXPECT_EQ(message(folder / "absent"),
            (folder / "absent").string() + ": cannot be read: no such file, or no permission");
  EXPECT_EQ(message(folder / "."), (folder / ".").string() + ": is a folder; expected a file");
}

std::string TextOf(const std::string& bytes) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "file", bytes);
  try {
    return ReadTextFile(folder / "file");
  } catch (const InputError& problem) {
    return problem.what();
  }
}

TEST(ReadTextFile, LeavesOutTheByteOrderMarkAndReadsLatin1) {
  EXPECT_EQ(TextOf("\xef\xbb\xbfx,y\r\n"), "x,y\r\n");
  EXPECT_EQ(TextOf("u [\xb5m]\n"), "u [\xc2\xb5m]\n");
  EXPECT_EQ(TextOf("u [\xc2\xb5m]\n"), "u [\xc2\xb5m]\n");
  EXPECT_EQ(TextOf("x\r1\r2\r"), "x\n1\n2\n") << "lines that end as on old Macintoshes";
}

TEST(ReadTextFile, NamesWhatIsNoUtf8) {
  EXPECT_THAT(TextOf(std::string("\xff\xfex\0,\0y\0\n\0", 10)),
              testing::HasSubstr("is encoded as UTF-16 (little endian); save it as UTF-8"));
  EXPECT_THAT(TextOf(std::string("x\0,\0y\0\n\0", 8)),
              testing::HasSubstr("is encoded as UTF-16 (little endian)"));
  EXPECT_THAT(TextOf(std::string("\0x\0,\0y\0\n", 8)),
              testing::HasSubstr("is encoded as UTF-16 (big endian)"));
  EXPECT_THAT(TextOf(std::string("\xff\xfe\0\0x\0\0\0", 8)), testing::HasSubstr("UTF-32"));
  EXPECT_THAT(TextOf("PK\x03\x04..."), testing::HasSubstr("Excel workbook"));
  EXPECT_THAT(TextOf(std::string("1,2\n\0", 5)), testing::HasSubstr("it is not a text"));
}

}  // namespace
}  // namespace lacuna
