// An append-only file of evaluations, from which an interrupted search resumes.
//
// A search is a function of its inputs and of the outcomes so far, so the log is its entire state:
// if it is called again with the same log, the search starts from the beginning, receives the
// outcomes from the file in order, and continues with new evaluations where the file ends. Each
// line contains the hash of its content, and numbers are written exactly. An incomplete last line,
// left by a crash, is removed. Each line is passed to the operating system immediately, but it is
// not flushed to the disk (fsync), so a power failure can lose the last lines.
#ifndef LACUNA_SEARCH_EVALUATION_LOG_H_
#define LACUNA_SEARCH_EVALUATION_LOG_H_

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "search/search_problem.h"

namespace lacuna {

class EvaluationLog {
 public:
  // Opens or creates the log of the search identified by `key`. Throws InputError with the file
  // (and line) if it cannot be written, and if it is damaged or belongs to another search: the
  // message then says to remove it.
  EvaluationLog(const std::filesystem::path& file, const std::string& key, int variable_count,
                int constraint_count);

  // The evaluations that were in the file when it was opened.
  const std::vector<SearchStep>& steps() const { return steps_; }

  // Writes one evaluation. Throws InputError if that fails.
  void Append(const SearchStep& step);

 private:
  std::filesystem::path file_;
  std::vector<SearchStep> steps_;
  std::ofstream stream_;
};

}  // namespace lacuna

#endif  // LACUNA_SEARCH_EVALUATION_LOG_H_
