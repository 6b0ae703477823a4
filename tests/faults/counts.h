// What was tried, kept in a file, so that hours of trials can be stopped and resumed.
#ifndef LACUNA_TESTS_FAULTS_COUNTS_H_
#define LACUNA_TESTS_FAULTS_COUNTS_H_

#include <filesystem>
#include <map>
#include <string>

namespace lacuna {

struct TrialOutcome {
  std::string failure{};    // empty: survived
  std::string note{};       // what noticed the fault
  int hidden_at_fault = 0;  // hidden files and folders that a killed process has left
  int hidden_at_end = 0;    // and those that the completed command leaves
};

// One line of JSON for each trial, written when it has ended. An incomplete last line, as a kill
// may leave it, is dropped.
class FaultCounts {
 public:
  // Opens or begins the file. `identity` names the program and the seed. Throws InputError naming
  // the file if it has another identity, is damaged or cannot be written.
  FaultCounts(const std::filesystem::path& file, const std::string& identity);

  // The outcome of the trial of this name; null if it was not tried yet.
  const TrialOutcome* Find(const std::string& trial) const;
  const TrialOutcome& Append(const std::string& trial, const TrialOutcome& outcome);

 private:
  void WriteLine(const std::string& line);

  std::filesystem::path file_;
  std::map<std::string, TrialOutcome> outcomes_;
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_COUNTS_H_
