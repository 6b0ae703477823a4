#include "core/workers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "core/claim.h"
#include "core/error.h"
#include "core/parallel.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

TEST(Claim, IsExclusiveAndNamesItsHolder) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "claimed";
  EXPECT_THAT(HolderOf(file), IsEmpty());
  {
    const Claim first(file), second(file);
    EXPECT_TRUE(first.holds());
    EXPECT_FALSE(second.holds());
    EXPECT_THAT(HolderOf(file), HasSubstr("process " + std::to_string(getpid())));
    // HolderOf takes no lock.
    EXPECT_FALSE(Claim(file).holds());
  }
  EXPECT_THAT(HolderOf(file), IsEmpty());
  EXPECT_TRUE(Claim(file).holds());
  EXPECT_THROW(Claim(folder / "absent/claimed"), InputError);
}

TEST(Workers, RunEachJobOnceInAProcessOfItsOwn) {
  const TemporaryFolder folder;
  const bool done = RunInProcesses(5, {.workers = 2, .threads = 3}, [&](size_t k) {
    std::ofstream(folder / std::to_string(k), std::ios::app)
        << (ThreadCount() == 3) << " " << getpid() << "\n";
  });
  EXPECT_TRUE(done);
  for (int k = 0; k < 5; ++k) {
    const std::string said = FileContent(folder / std::to_string(k));
    EXPECT_EQ(said.rfind("1 ", 0), 0u) << said;
    EXPECT_EQ(said.find(std::to_string(getpid()) + "\n"), std::string::npos);
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  }
}

TEST(Workers, ReportACrashAndContinueWithTheOtherJobs) {
  const TemporaryFolder folder;
  std::map<size_t, std::string> crashed;
  WorkerOptions options;
  options.crashed = [&](size_t k, const std::string& reason) { crashed[k] = reason; };
  const bool done = RunInProcesses(4, options, [&](size_t k) {
    if (k == 0) {
      signal(SIGSEGV, SIG_DFL);  // a sanitizer would end the process in another way
      raise(SIGSEGV);
    }
    if (k == 1) throw std::runtime_error("out of luck");
    if (k == 2) raise(SIGKILL);  // from outside: no mistake of the job
    std::ofstream(folder / "done") << k;
  });
  EXPECT_FALSE(done);
  EXPECT_THAT(crashed, ElementsAre(Key(0), Key(1)));
  EXPECT_THAT(crashed[0], HasSubstr("signal 11"));
  EXPECT_EQ(FileContent(folder / "done"), "3");
}

}  // namespace
}  // namespace lacuna
