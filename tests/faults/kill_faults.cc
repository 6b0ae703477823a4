// Processes that are killed, and two at once.
#include <fmt/format.h>

#include <algorithm>

#include "faults/folder_content.h"
#include "faults/trial.h"
#include "support/temporary_folder.h"

namespace lacuna {

namespace fs = std::filesystem;

std::vector<FaultResult> Killed(Trial* trial) {
  FaultResult killed{"killed at a random moment", trial->subject().name};
  FaultResult litter{"files left over by the kills", trial->subject().name};
  trial->StartOver();
  int most = 0;
  for (int kill = 1; kill <= trial->options().kills; ++kill) {
    const TrialOutcome& outcome =
        trial->Try(&killed, fmt::format("kill {}", kill), [&](std::mt19937_64* random) {
          TrialOutcome one;
          // Uniform over the time of the whole run. A command that has ended before, from what the
          // kills before had left, begins anew.
          std::uniform_real_distribution<double> share(0, 1);
          while (true) {
            Process process = trial->Start();
            if (!process.EndsWithin(share(*random) * trial->Duration())) {
              process.Kill();
              break;
            }
            trial->StartOver();
          }
          // Each kill is judged from a copy, so that the next one finds what this one has left.
          fs::remove_all(trial->Left());
          if (fs::exists(trial->Results()))
            fs::copy(trial->Results(), trial->Left(), fs::copy_options::recursive);
          one.hidden_at_fault = CountHidden(trial->Left());
          one.failure = trial->Finish();
          one.hidden_at_end = CountHidden(trial->Results());
          trial->Reset(trial->Left());
          return one;
        });
    most = std::max(most, outcome.hidden_at_fault);
    ++litter.trials;
    litter.survived += outcome.hidden_at_end == 0;
    if (outcome.hidden_at_end > 0 && litter.first_failure.empty())
      litter.first_failure = fmt::format("kill {}: {} hidden files after the command has ended",
                                         kill, outcome.hidden_at_end);
  }
  litter.note = fmt::format("after a kill at most {}, after the final completion {}", most,
                            litter.survived == litter.trials ? "none" : "some");
  return {killed, litter};
}

namespace {

// What is wrong with a process that has ended with this status beside another one.
std::string BesideAnother(int status, const fs::path& log, const Subject& subject) {
  const std::string said = FileContent(log);
  if (status == 0 || (status > 0 && said.find(subject.refused_words) != std::string::npos))
    return "";
  return fmt::format("exit status {} without \"{}\": {}", status, subject.refused_words, said);
}

}  // namespace

FaultResult TwoProcesses(Trial* trial) {
  FaultResult result{"two processes at once", trial->subject().name};
  trial->Try(&result, "twice", [&]() -> std::string {
    trial->StartOver();
    const fs::path log = trial->Folder() / "log_2.txt";
    Process first = trial->Start();
    Process second(trial->options().program, trial->subject().arguments, trial->Folder(), log);
    const int one = first.Wait(), other = second.Wait();
    if (one != 0 && other != 0)
      return "neither has finished: " + FileContent(trial->Log()) + FileContent(log);
    for (const std::string& problem : {BesideAnother(one, trial->Log(), trial->subject()),
                                       BesideAnother(other, log, trial->subject())})
      if (!problem.empty()) return problem;
    return Difference(trial->Expected(), ContentOf(trial->Results()));
  });
  return result;
}

}  // namespace lacuna
