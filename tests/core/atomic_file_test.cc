#include "core/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class AtomicFileTest : public ::testing::Test {
 protected:
  int FileCount() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder_.Path()), {}));
  }
  const TemporaryFolder folder_;
};

TEST_F(AtomicFileTest, ReplacesTheWholeContentAndLeavesNoOtherFile) {
  WriteFileAtomically(folder_ / "a", "the first, longer content");
  WriteFileAtomically(folder_ / "a", "second");
  EXPECT_EQ(FileContent(folder_ / "a"), "second");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, UncommittedContentIsDiscarded) {
  WriteFileAtomically(folder_ / "a", "old");
  {
    AtomicFile file(folder_ / "a");
    file.Write("new");
    EXPECT_EQ(FileContent(folder_ / "a"), "old");
  }
  EXPECT_EQ(FileContent(folder_ / "a"), "old");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, ProcessKilledWhileWritingLeavesTheOldContent) {
  WriteFileAtomically(folder_ / "a", "old");
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile file(folder_ / "a");
    file.Write(std::string(1 << 20, 'x'));
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(FileContent(folder_ / "a"), "old");
}

TEST_F(AtomicFileTest, PiecesAreJoinedInOrder) {
  AtomicFile file(folder_ / "a");
  file.Write("one ");
  file.Write("");
  file.Write("two");
  file.Commit();
  EXPECT_EQ(FileContent(folder_ / "a"), "one two");
}

TEST_F(AtomicFileTest, LinkKeepsPointingToTheFileThatIsReplaced) {
  WriteFileAtomically(folder_ / "target", "old");
  fs::create_symlink("target", folder_ / "link");
  WriteFileAtomically(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(FileContent(folder_ / "target"), "new");
}

TEST_F(AtomicFileTest, ErrorNamesTheUnwritablePlaceAndTheCause) {
  WriteFileAtomically(folder_ / "file", "");
  const auto expect = [](const fs::path& file, const std::string& cause) {
    EXPECT_THAT(
        [&] { WriteFileAtomically(file, "x"); },
        ThrowsMessage<InputError>(::testing::AllOf(HasSubstr(file.string()), HasSubstr(cause))));
  };
  expect(folder_ / "file/below_a_file", "Not a directory");
  expect(folder_ / "absent/a", "No such file or directory");
  expect(folder_.Path(), "not an ordinary file");
  expect("/dev/null", "not an ordinary file");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFileTest, FullDiskIsAnErrorAndKeepsTheOldContent) {
  // A limit on the file size imitates a full disk: write(2) fails in the same place.
  WriteFileAtomically(folder_ / "a", "old");
  const auto write_beyond_the_limit = [this] {
    signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    limit.rlim_cur = limit.rlim_max = 1000;
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      WriteFileAtomically(folder_ / "a", std::string(5000, 'x'));
    } catch (const InputError& error) {
      _exit(std::string(error.what()).find("too large") != std::string::npos ? 3 : 4);
    }
    _exit(0);
  };
  EXPECT_EXIT(write_beyond_the_limit(), ::testing::ExitedWithCode(3), "");
  EXPECT_EQ(FileContent(folder_ / "a"), "old");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, WhatAKilledProcessHasLeftIsRemovedAndWhatALivingOneWritesIsNot) {
  fs::create_directory(folder_ / "below");
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile file(folder_ / "below/a");
    file.Write("half");
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_FALSE(fs::is_empty(folder_ / "below"));
  WriteFileAtomically(folder_ / ".hidden.tmp", "not ours: it has no numbers");
  AtomicFile living(folder_ / "b");
  living.Write("new");
  RemoveLeftTemporaries(folder_.Path());
  EXPECT_TRUE(fs::is_empty(folder_ / "below"));
  EXPECT_TRUE(fs::exists(folder_ / ".hidden.tmp"));
  living.Commit();
  EXPECT_EQ(FileContent(folder_ / "b"), "new");
  RemoveLeftTemporaries(folder_ / "absent");
}

TEST(TemporaryFile, IsKnownByItsName) {
  EXPECT_TRUE(IsTemporaryFile("run/.manifest.json.4711.0.tmp"));
  EXPECT_TRUE(IsTemporaryFile(".a.1.23.tmp"));
  for (const char* other :
       {"a.1.2.tmp", ".a.1.tmp", ".a.1.x.tmp", ".1.2.tmp", ".a..2.tmp", ".a.tmp"})
    EXPECT_FALSE(IsTemporaryFile(other)) << other;
}

}  // namespace
}  // namespace lacuna
