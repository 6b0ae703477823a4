#include "sweep/sweep_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/memory_limit.h"
#include "core/workers.h"
#include "sweep/sweep_case.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

bool IsToRun(const fs::path& case_folder, bool retry_failed) {
  const auto outcome = ReadOutcome(case_folder);
  return !outcome || (retry_failed && !outcome->done);
}

// Redirects the standard output and standard error of this process to `file`.
void SpeakInto(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0 || dup2(descriptor, STDOUT_FILENO) < 0 || dup2(descriptor, STDERR_FILENO) < 0)
    throw InputError({file.string()}, fmt::format("cannot be written: {}", std::strerror(errno)));
  close(descriptor);
}

std::string EndOf(const SweepCase& entry, const CaseOutcome& outcome) {
  if (outcome.done) return fmt::format("{} done, {:.0f} s\n", entry.name, outcome.seconds);
  return fmt::format("{} failed: {}\n", entry.name, outcome.message);
}

// Says in log.txt and on the terminal that a case did not fit into the memory of this machine. It
// gets no outcome: a machine with more memory, or a higher --memory-limit, may run it.
void SayDoesNotFit(const SweepCase& entry, const std::string& reason, int terminal) {
  const std::string line = fmt::format("{} does not fit into memory: {}\n", entry.name, reason);
  for (const int descriptor : {STDERR_FILENO, terminal})
    if (descriptor >= 0) dprintf(descriptor, "%s", line.c_str());
}

// Runs one case, in a process of its own.
void RunCase(const SweepIdentity& identity, const SweepCase& entry, const fs::path& case_folder,
             bool retry_failed) {
  const Claim claim(case_folder / "claimed");
  if (!claim.holds() || !IsToRun(case_folder, retry_failed)) return;
  RemoveLeftTemporaries(case_folder);
  const auto began = std::chrono::steady_clock::now();
  const int terminal = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
  SpeakInto(case_folder / "log.txt");
  CaseOutcome outcome;
  try {
    Progress progress;
    outcome = RunCommand(identity.command, entry.settings, case_folder, &progress);
  } catch (const Interrupted&) {
    throw;
  } catch (const OutOfMemory& problem) {
    SayDoesNotFit(entry, problem.what(), terminal);
    return;
  } catch (const std::bad_alloc&) {
    SayDoesNotFit(entry, "an allocation failed", terminal);
    return;
  } catch (const std::exception& problem) {
    outcome = {};
    outcome.message = problem.what();
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  WriteOutcome(outcome, case_folder);
  if (terminal < 0) return;
  dprintf(terminal, "%s", EndOf(entry, outcome).c_str());
  close(terminal);
}

// Saves the outcome of a case whose process crashed, unless another process is working on it. For a
// case that was run again it replaces the earlier failure.
void KeepCrash(const SweepCase& entry, const fs::path& case_folder, const std::string& reason,
               bool retries) {
  const Claim claim(case_folder / "claimed");
  const auto before = ReadOutcome(case_folder);
  if (!claim.holds() || (before && (before->done || !retries))) return;
  CaseOutcome outcome;
  outcome.message = reason + "; its last output is in log.txt";
  WriteOutcome(outcome, case_folder);
  fmt::print(stderr, "{}", EndOf(entry, outcome));
}

std::vector<SweepCase> Chosen(const fs::path& folder, const std::vector<int>& numbers) {
  std::vector<SweepCase> cases = ReadCases(folder);
  if (numbers.empty()) return cases;
  std::vector<SweepCase> chosen;
  for (const int number : numbers) {
    const auto found = std::find_if(cases.begin(), cases.end(), [number](const SweepCase& entry) {
      return entry.number == number;
    });
    if (found == cases.end())
      throw InputError({folder.string()}, fmt::format("has no case {}", number));
    chosen.push_back(*found);
  }
  return chosen;
}

}  // namespace

int RunSweep(const fs::path& given_folder, const SweepRunOptions& options) {
  const SweepIdentity identity = ReadIdentity(given_folder);
  const fs::path folder = fs::canonical(given_folder);
  const std::vector<SweepCase> cases = Chosen(folder, options.numbers);
  std::vector<SweepCase> to_run;
  for (const SweepCase& entry : cases)
    if (IsToRun(folder / entry.name, options.retry_failed)) to_run.push_back(entry);
  WorkerOptions work{.workers = options.workers, .threads = options.threads};
  work.crashed = [&](size_t k, const std::string& reason) {
    KeepCrash(to_run[k], folder / to_run[k].name, reason, options.retry_failed);
  };
  RunInProcesses(to_run.size(), work, [&](size_t k) {
    RunCase(identity, to_run[k], folder / to_run[k].name, options.retry_failed);
  });
  ThrowIfInterrupted();
  int unfinished = 0;
  for (const SweepCase& entry : cases) {
    const auto outcome = ReadOutcome(folder / entry.name);
    unfinished += !outcome || !outcome->done;
  }
  return unfinished;
}

std::vector<int> UnfinishedCases(const fs::path& folder, const SweepRunOptions& options) {
  ReadIdentity(folder);
  std::vector<int> numbers;
  for (const SweepCase& entry : Chosen(folder, options.numbers))
    if (IsToRun(folder / entry.name, options.retry_failed)) numbers.push_back(entry.number);
  return numbers;
}

}  // namespace lacuna
