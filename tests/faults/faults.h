// Faults that a computation must survive: killed at any moment, a full disk, a folder that cannot
// be written to, damaged results, inputs that change, a clock that jumps, two processes in one
// folder. After each of them the same command must give the same bytes as a computation that
// nothing disturbed, or say what is wrong (docs/faults.md).
#ifndef LACUNA_TESTS_FAULTS_FAULTS_H_
#define LACUNA_TESTS_FAULTS_FAULTS_H_

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lacuna {

// A command whose results are compared, run in a folder that holds all its inputs.
struct Subject {
  std::string name;                        // "fit"
  std::vector<std::string> arguments;      // of the program
  std::filesystem::path results;           // the folder that it writes, below the working folder
  std::vector<std::string> preparation{};  // arguments of a command that must have run before
  // Whether the command checks the files that the preparation has written, and the preparation
  // mends them. Otherwise they are inputs, which people may edit.
  bool preparation_mends = false;
  std::filesystem::path input{};  // a file that the command reads, below the working folder
  // Whether the input is read during the whole run; otherwise it is read once, at the start.
  bool reads_input_late = true;
  // How many manifests show that all inputs have been hashed.
  int manifests = 1;
  int refusal = 2;  // exit status if the input changes meanwhile
  // A file that marks a part of the results as done, so that it is not looked at again. A finished
  // run is disturbed without these marks, as if it had been stopped just before its end.
  std::string mark{};
  // What a process says that finds another one at work in the folder.
  std::string refused_words = "is in use by another run";
};

struct FaultOptions {
  std::filesystem::path program;   // lacuna
  std::filesystem::path sources;   // the folder that contains experiments/
  std::filesystem::path folder;    // for the runs, and counts.jsonl
  int kills = 2;                   // how often each subject is killed
  int damaged_files = 1;           // how many files of a stage are damaged, each in two ways
  int full_disks = 2;              // how many sizes of a small disk are tried
  std::filesystem::path faketime;  // libfaketime; empty: absent
  uint64_t seed = 1;               // of the random moments and files
};

struct FaultResult {
  std::string fault, subject;
  int trials = 0, survived = 0;
  std::string note = {};           // what noticed the fault, or why it was not tried
  std::string first_failure = {};  // empty: none
};

// The commands whose inputs are bundled with the sources: reconstruct, fit, diagnose, table1 and
// sweep.
std::vector<Subject> BundledSubjects();

// Copies the experiments of BundledSubjects, and writes the small ones among them, into a working
// folder.
void WriteExperiments(const std::filesystem::path& sources, const std::filesystem::path& folder);

// All faults for one subject, in the subject's folder, which is emptied. What was tried before with
// the same program, seed and folder is read from counts.jsonl and not tried again. `report` sees
// each result as soon as it is known. Throws InputError if the folder is not empty and holds no
// counts.jsonl, if that belongs to another seed, to another program under test or to another
// version of this one, or if the undisturbed command fails.
std::vector<FaultResult> TryFaults(
    const Subject& subject, const FaultOptions& options,
    const std::function<void(const FaultResult&)>& report = [](const FaultResult&) {});

// The library that Debian's package faketime installs; empty if it is absent.
std::filesystem::path FindFaketime();

// A table in Markdown.
std::string FaultTable(const std::vector<FaultResult>& results);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_FAULTS_H_
