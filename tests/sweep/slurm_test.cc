#include "sweep/slurm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "core/error.h"
#include "support/interrupted_call.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Sets PATH to a folder that contains only this sbatch, for the lifetime of the object.
class OnlySbatch {
 public:
  OnlySbatch(const std::filesystem::path& folder, const std::string& script)
      : before_(std::getenv("PATH")) {
    if (!script.empty()) {
      std::ofstream(folder / "sbatch") << "#!/bin/sh\n" << script;
      chmod((folder / "sbatch").c_str(), 0755);
    }
    setenv("PATH", folder.c_str(), 1);
  }
  ~OnlySbatch() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

TEST(Slurm, ArraysConsistOfRangesAndSingleCases) {
  EXPECT_EQ(ArrayOf({4}), "4");
  EXPECT_EQ(ArrayOf({1, 2, 3, 7, 9, 10}), "1-3,7,9-10");
}

TEST(Slurm, AJobRunsOneCasePerTaskWithTheGivenOptions) {
  SlurmOptions options;
  options.program = "/opt/a lacuna/bin";
  options.numbers = {1, 2, 5};
  options.at_a_time = 2;
  const std::string script = SlurmScript("/data/it's mine", options);
  EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-2,5%2\n"));
  EXPECT_THAT(script, HasSubstr("exec '/opt/a lacuna/bin' --threads \"${SLURM_CPUS_PER_TASK:-1}\" "
                                "sweep run '/data/it'\\''s mine' --case "
                                "\"$SLURM_ARRAY_TASK_ID\"\n"));
  options.memory_limit = 4'000'000'000;
  EXPECT_THAT(SlurmScript("/data", options),
              HasSubstr(":-1}\" --memory-limit 4000000000 sweep run '/data' --case "));
}

TEST(Slurm, SubmitsWithFurtherOptionsAndReturnsTheJobId) {
  const TemporaryFolder folder;
  const OnlySbatch path(folder.Path(),
                        "echo \"$@\" > given\nfor last; do :; done\n"
                        "while read -r line; do echo \"$line\"; done < \"$last\" "
                        "> seen\necho '17;cluster'\n");
  SlurmOptions options;
  options.program = "/bin/lacuna";
  options.numbers = {3};
  options.options = {"--time=60"};
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.Path());
  const std::string job = SubmitToSlurm(folder.Path(), options);
  std::filesystem::current_path(before);
  EXPECT_EQ(job, "17");
  EXPECT_THAT(FileContent(folder / "given"),
              AllOf(HasSubstr("--parsable"), HasSubstr("--time=60"), HasSubstr("slurm/job.sh")));
  EXPECT_THAT(FileContent(folder / "seen"), HasSubstr("--array=3"));
}

TEST(Slurm, ReportsAMissingOrRefusingSbatch) {
  const TemporaryFolder folder;
  SlurmOptions options;
  options.numbers = {1};
  {
    const OnlySbatch path(folder.Path(), "");
    EXPECT_THAT([&] { SubmitToSlurm(folder.Path(), options); },
                ThrowsMessage<InputError>(HasSubstr("no sbatch in PATH")));
  }
  const OnlySbatch path(folder.Path(), "exit 1\n");
  EXPECT_THAT([&] { SubmitToSlurm(folder.Path(), options); },
              ThrowsMessage<InputError>(HasSubstr("sbatch refused")));
}

[[noreturn]] void InterruptSbatch(const TemporaryFolder& folder) {
  const OnlySbatch path(folder.Path(), "");
  WriteNumberedScript(folder / "sbatch", folder / "number", "exec /bin/sleep 60");
  SlurmOptions options;
  options.numbers = {1};
  options.wait = true;
  ExitAfterInterruptedCall(folder / "number", [&] { SubmitToSlurm(folder.Path(), options); });
}

TEST(SlurmDeathTest, AnInterruptEndsSbatch) {
  const TemporaryFolder folder;
  EXPECT_EXIT(InterruptSbatch(folder), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lacuna
