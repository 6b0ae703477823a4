// One subject in a folder of its own, with what every fault needs: the undisturbed results, and the
// means to set the folder back and to run the command to its end.
#ifndef LACUNA_TESTS_FAULTS_TRIAL_H_
#define LACUNA_TESTS_FAULTS_TRIAL_H_

#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "faults/counts.h"
#include "faults/faults.h"
#include "faults/process.h"

namespace lacuna {

class Trial {
 public:
  using Content = std::map<std::string, std::string>;  // hash by name of the file

  // Empties the folder and runs the command undisturbed. Throws InputError if it fails.
  Trial(const Subject& subject, const FaultOptions& options, FaultCounts* counts);

  const Subject& subject() const { return subject_; }
  const FaultOptions& options() const { return options_; }
  const std::filesystem::path& Folder() const { return folder_; }    // of the experiments
  const std::filesystem::path& Results() const { return results_; }  // of the command
  std::filesystem::path Log() const { return folder_ / "log.txt"; }
  // Copies of the results: those before the command, the undisturbed ones, and those that a
  // disturbed command has left.
  std::filesystem::path Prepared() const;
  std::filesystem::path Finished() const;
  std::filesystem::path Left() const;
  const Content& Expected() const { return expected_; }
  Seconds Duration() const { return duration_; }  // of the undisturbed command

  // Counts a trial, after having made it if it was not made before. What it needs at random comes
  // from the generator, which depends on the seed and the name.
  using Make = std::function<TrialOutcome(std::mt19937_64* random)>;
  const TrialOutcome& Try(FaultResult* result, const std::string& name, const Make& make);
  // The same for a trial that has nothing to say but what failed.
  void Try(FaultResult* result, const std::string& name, const std::function<std::string()>& make);
  std::mt19937_64 RandomOf(const std::string& name) const;

  // The program under test with the subject's arguments, not waited for.
  Process Start(const ProcessOptions& options = {}) const;
  int Execute(const std::vector<std::string>& arguments, const ProcessOptions& options = {});
  int Run(const ProcessOptions& options = {}) { return Execute(subject_.arguments, options); }
  // Runs the command to its end; what is wrong afterwards.
  std::string Finish(const ProcessOptions& options = {});
  // What the command has said, also in the logs among its results.
  std::string Said() const;
  bool HasSaid(const std::string& text) const { return Said().find(text) != std::string::npos; }

  // Sets the results to a copy of the folder, which may be absent.
  void Reset(const std::filesystem::path& from);
  void StartOver() { Reset(Prepared()); }
  // Sets the results to the finished ones, without the marks that they are done.
  void ResetToFinished();

 private:
  void Require(const std::vector<std::string>& arguments);

  const Subject& subject_;
  const FaultOptions& options_;
  FaultCounts* counts_;
  const std::filesystem::path folder_, results_;
  Content expected_;
  Seconds duration_{};
};

// The faults, each as one row of the table or several.
FaultResult TwoProcesses(Trial* trial);
std::vector<FaultResult> Killed(Trial* trial);
FaultResult LimitedFiles(Trial* trial);
FaultResult FullDisk(Trial* trial);
FaultResult FileTimes(Trial* trial);
FaultResult FakedClock(Trial* trial);
std::vector<FaultResult> Damaged(Trial* trial);
FaultResult ChangedInput(Trial* trial);
FaultResult InputChangedMeanwhile(Trial* trial);
FaultResult UnwritableOutput(Trial* trial);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_TRIAL_H_
