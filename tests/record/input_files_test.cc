#include "record/input_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/hash.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// All files are written in other sizes than before: the clock of a file system may be coarse.
class InputFilesTest : public ::testing::Test {
 protected:
  void Write(const std::string& content) const { std::ofstream(file_) << content; }
  auto NamesIt() const {
    return ThrowsMessage<InputError>(
        AllOf(HasSubstr(file_.string()), HasSubstr("has changed while this command was reading")));
  }

  const TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "markers.csv";
};

TEST_F(InputFilesTest, AreHashedByName) {
  Write("1\n");
  InputFiles inputs;
  inputs.Add("a/markers.csv", StateOf(file_));
  EXPECT_EQ(inputs.hashes().at("a/markers.csv"), HashFile(file_));
  EXPECT_NO_THROW(inputs.RequireUnchanged());
}

TEST_F(InputFilesTest, AChangeBetweenTheReadingAndTheHashIsSeen) {
  Write("1\n");
  const FileState before = StateOf(file_);
  Write("1\n2\n");
  InputFiles inputs;
  EXPECT_THAT([&] { inputs.Add("markers.csv", before); }, NamesIt());
}

TEST_F(InputFilesTest, AChangeAfterTheHashIsSeen) {
  Write("1\n");
  InputFiles inputs;
  inputs.Add("markers.csv", StateOf(file_));
  Write("1\n2\n");
  EXPECT_THAT([&] { inputs.RequireUnchanged(); }, NamesIt());
  Write("1\n");
  EXPECT_NO_THROW(inputs.RequireUnchanged());
  std::filesystem::remove(file_);
  EXPECT_THAT([&] { inputs.RequireUnchanged(); },
              ThrowsMessage<InputError>(HasSubstr(file_.string())));
}

TEST_F(InputFilesTest, AFileThatIsOnlyTouchedIsUnchanged) {
  Write("1\n");
  InputFiles inputs;
  const FileState before = StateOf(file_);
  inputs.Add("markers.csv", before);
  std::filesystem::last_write_time(file_, {});
  EXPECT_NE(StateOf(file_), before);
  EXPECT_NO_THROW(inputs.RequireUnchanged());
}

TEST_F(InputFilesTest, FilesOfOneNameBothCount) {
  const std::filesystem::path other = folder_ / "other.csv";
  const auto hash_of_both = [&] {
    InputFiles inputs;
    inputs.Add("markers.csv", StateOf(file_));
    inputs.Add("markers.csv", StateOf(other));
    return inputs.hashes().at("markers.csv");
  };
  Write("1\n");
  std::ofstream(other) << "2\n";
  const std::string both = hash_of_both();
  EXPECT_NE(both, HashFile(file_));
  std::ofstream(other) << "3\n";
  EXPECT_NE(hash_of_both(), both);
}

}  // namespace
}  // namespace lacuna
