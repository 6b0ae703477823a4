// Faults that a computation must survive: killed at any moment, a full disk, a folder that cannot
// be written to, damaged results, inputs that change, a clock that jumps, two processes in one
// folder. After each of them the same command must give the same bytes as a computation that
// nothing disturbed, or say what is wrong.
#ifndef LACUNA_TESTS_FAULTS_FAULTS_H_
#define LACUNA_TESTS_FAULTS_FAULTS_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

// A command whose results are compared, run in a folder that holds all its inputs.
struct Subject {
  std::string name;                        // "fit"
  std::vector<std::string> arguments;      // of the program
  std::filesystem::path results;           // the folder that it writes, below the working folder
  std::vector<std::string> preparation{};  // arguments of a command that must have run before
  std::filesystem::path input{};  // a file that the command reads, below the working folder
};

struct FaultOptions {
  std::filesystem::path program;  // lacuna
  std::filesystem::path sources;  // the folder that contains experiments/
  std::filesystem::path folder;   // for the runs; it is emptied
  int kills = 2;                  // how often each subject is killed
  int damaged_files = 2;          // how many files of a result are damaged, each in two ways
  uint64_t seed = 1;
};

struct FaultResult {
  std::string fault, subject;
  int trials = 0, survived = 0;
  std::string first_failure = {};  // empty: none
};

// The commands whose inputs are bundled with the sources: reconstruct, fit and diagnose.
std::vector<Subject> BundledSubjects();

// All faults for one subject. Throws InputError if the undisturbed command fails.
std::vector<FaultResult> TryFaults(const Subject& subject, const FaultOptions& options);

// A table in Markdown.
std::string FaultTable(const std::vector<FaultResult>& results);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_FAULTS_H_
