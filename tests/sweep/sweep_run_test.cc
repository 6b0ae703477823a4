#include "sweep/sweep_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/claim.h"
#include "core/error.h"
#include "core/memory_limit.h"
#include "small_sweep.h"
#include "support/temporary_folder.h"
#include "sweep/sweep_table.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr char kTwo[] = "vary: {mesh.max_volume: [100 mm^3, 200 mm^3]}\n";

CaseOutcome MadeUp(double value) {
  CaseOutcome outcome;
  outcome.done = true;
  outcome.numbers = {{"best_value_m", value}, {"lost", kNotMeasured}};
  outcome.words = {{"ended", "said \"so\", twice"}};
  outcome.seconds = 1.5;
  return outcome;
}

// A process that claims a file and keeps it until it is killed.
class Holder {
 public:
  explicit Holder(const std::filesystem::path& file) {
    int ready[2];
    if (pipe(ready) != 0) abort();
    child_ = fork();
    if (child_ == 0) {
      const Claim claim(file);
      if (!claim.holds() || write(ready[1], "x", 1) != 1) _exit(1);
      while (true) pause();
    }
    char byte = 0;
    if (read(ready[0], &byte, 1) != 1) abort();
    close(ready[0]);
    close(ready[1]);
  }
  ~Holder() { Kill(); }
  void Kill() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    child_ = -1;
  }
  pid_t Id() const { return child_; }

 private:
  pid_t child_ = -1;
};

class SweepRunTest : public ::testing::Test {
 protected:
  // The second frame is missing, so that a run fails at once with a message.
  void PlanWithoutSecondFrame() {
    plan_ = PlanSmallSweep(folder_.Path(), kTwo);
    std::filesystem::remove(folder_ / "recording/b.xyz");
  }
  std::filesystem::path Case(size_t k) const { return sweep_ / plan_.cases[k].name; }

  TemporaryFolder folder_;
  const std::filesystem::path sweep_ = folder_ / "cases";
  SweepPlan plan_;
};

TEST_F(SweepRunTest, AFailureHasItsReasonAndDoneCasesAreKept) {
  PlanWithoutSecondFrame();
  WriteOutcome(MadeUp(0.25), Case(0));
  const std::string before = FileContent(Case(0) / "outcome.json");
  EXPECT_THAT(UnfinishedCases(sweep_, {}), ElementsAre(2));
  EXPECT_EQ(RunSweep(sweep_, {.workers = 2}), 1);
  EXPECT_EQ(FileContent(Case(0) / "outcome.json"), before);
  const auto failed = ReadOutcome(Case(1));
  ASSERT_TRUE(failed.has_value());
  EXPECT_FALSE(failed->done);
  EXPECT_THAT(failed->message, HasSubstr("b.xyz"));
  // It is not run again unless that is requested.
  const std::string first = FileContent(Case(1) / "outcome.json");
  EXPECT_EQ(RunSweep(sweep_, {}), 1);
  EXPECT_EQ(FileContent(Case(1) / "outcome.json"), first);
  EXPECT_THAT(UnfinishedCases(sweep_, {.retry_failed = true}), ElementsAre(2));
  EXPECT_THAT([&] { UnfinishedCases(sweep_, {.numbers = {99}}); },
              ThrowsMessage<InputError>(HasSubstr("has no case 99")));
  std::filesystem::rename(folder_ / "recording/a.xyz", folder_ / "recording/b.xyz");
  EXPECT_EQ(RunSweep(sweep_, {.retry_failed = true}), 1);
  EXPECT_THAT(ReadOutcome(Case(1))->message, HasSubstr("a.xyz"));
}

TEST_F(SweepRunTest, SkipsACaseThatAnotherProcessHasClaimed) {
  PlanWithoutSecondFrame();
  Holder holder(Case(0) / "claimed");
  EXPECT_EQ(RunSweep(sweep_, {}), 2);
  EXPECT_FALSE(ReadOutcome(Case(0)).has_value());
  EXPECT_TRUE(ReadOutcome(Case(1)).has_value());
  const SweepTable table = CollectSweep(sweep_);
  EXPECT_EQ(table.rows[0].status, CaseStatus::kRunning);
  EXPECT_THAT(table.rows[0].note, HasSubstr("process " + std::to_string(holder.Id())));
  holder.Kill();
  // Its claim was released when it ended.
  EXPECT_EQ(CollectSweep(sweep_).rows[0].status, CaseStatus::kPlanned);
  EXPECT_EQ(RunSweep(sweep_, {}), 2);
  EXPECT_TRUE(ReadOutcome(Case(0)).has_value());
}

TEST_F(SweepRunTest, RunsOnlyTheRequestedCases) {
  PlanWithoutSecondFrame();
  EXPECT_EQ(RunSweep(sweep_, {.numbers = {2}}), 1);
  EXPECT_FALSE(ReadOutcome(Case(0)).has_value());
  EXPECT_TRUE(ReadOutcome(Case(1)).has_value());
  EXPECT_THROW(RunSweep(sweep_, {.numbers = {3}}), InputError);
  EXPECT_THROW(RunSweep(folder_.Path(), {}), InputError);
}

TEST_F(SweepRunTest, ACaseThatDoesNotFitIntoMemoryStaysPlanned) {
  std::ofstream(folder_ / "fits.yaml")
      << "schema_version: 1\nname: fits\ncommand: fit\n"
      << "experiments: " << LACUNA_SOURCE_DIR << "/experiments/hidden_effect.yaml\n";
  plan_ = PlanSweep(Config::Load(folder_ / "fits.yaml"), sweep_);
  SetMemoryLimit(1);  // byte
  EXPECT_EQ(RunSweep(sweep_, {}), 1);
  SetMemoryLimit(0);
  EXPECT_FALSE(ReadOutcome(Case(0)).has_value());
  EXPECT_THAT(UnfinishedCases(sweep_, {}), ElementsAre(1));
  EXPECT_THAT(FileContent(Case(0) / "log.txt"), HasSubstr("does not fit into memory: "));
}

TEST_F(SweepRunTest, CollectListsEveryCaseReproducibly) {
  plan_ = PlanSmallSweep(folder_.Path(), std::string(kTwo) + "cases: [{forces.model: none}]\n");
  WriteOutcome(MadeUp(0.25), Case(0));
  CaseOutcome failed;
  failed.message = "frame 3: no convergence";
  WriteOutcome(failed, Case(2));
  const auto collect = [this] {
    WriteTable(CollectSweep(sweep_), sweep_);
    return FileContent(sweep_ / "table.txt") + FileContent(sweep_ / "table.csv") +
           FileContent(sweep_ / "table.json");
  };
  const std::string once = collect();
  EXPECT_EQ(collect(), once);
  const std::string words = FileContent(sweep_ / "table.txt");
  EXPECT_THAT(words, AllOf(HasSubstr("3 cases of small: 1 done, 1 failed, 0 running, 1 planned"),
                           HasSubstr("failed: frame 3: no convergence"), HasSubstr("1 unfinished"),
                           HasSubstr("0.25")));
  const std::string csv = FileContent(sweep_ / "table.csv");
  EXPECT_THAT(csv, HasSubstr("number,case,experiment,mesh.max_volume,forces.model,status,note,"
                             "seconds,best_value_m,lost,ended\n"));
  EXPECT_THAT(csv, HasSubstr(",bend.yaml,100 mm^3,,done,,1.5,0.25,nan,\"said \"\"so\"\", twice\""));
  EXPECT_THAT(FileContent(sweep_ / "table.json"), HasSubstr("\"lost\": null"));
  // Planning again neither renames nor overwrites existing cases.
  PlanSmallSweep(folder_.Path(), std::string(kTwo) + "cases: [{forces.model: none}]\n");
  EXPECT_EQ(collect(), once);
}

TEST_F(SweepRunTest, ErrorNamesADamagedOutcome) {
  plan_ = PlanSmallSweep(folder_.Path(), kTwo);
  std::ofstream(Case(1) / "outcome.json") << "{\"schema_version\": 1, \"done\"";
  EXPECT_THAT([this] { CollectSweep(sweep_); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("outcome.json")));
}

TEST_F(SweepRunTest, AnOutcomeWithAnotherNumberIsRefused) {
  plan_ = PlanSmallSweep(folder_.Path(), kTwo);
  WriteOutcome(MadeUp(0.25), Case(0));
  EXPECT_TRUE(ReadOutcome(Case(0))->done);
  std::string text = FileContent(Case(0) / "outcome.json");
  const size_t at = text.find("0.25");
  ASSERT_NE(at, std::string::npos);
  std::ofstream(Case(0) / "outcome.json") << text.replace(at, 4, "0.27");
  EXPECT_THAT(
      [this] { ReadOutcome(Case(0)); },
      ::testing::ThrowsMessage<InputError>(AllOf(HasSubstr("outcome.json"), HasSubstr("damaged"))));
}

}  // namespace
}  // namespace lacuna
