// An append-only file of evaluations, from which a stopped search goes on.
//
// A search is a function of its inputs and of the outcomes so far, so that the log is all the state
// there is: called again with the same log, the search starts afresh, is given the outcomes of the
// file in their order, and goes on where the file ends. Each line carries the hash of its content,
// and numbers are written exactly; a last line that was torn by a crash is dropped. Lines reach the
// system one by one, the disk when the system writes them there.
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
  // Opens or begins the log of the search named by `key`. Throws InputError naming the file, and
  // the line where there is one, when it cannot be written, is damaged, or belongs to another
  // search.
  EvaluationLog(const std::filesystem::path& file, const std::string& key, int variable_count,
                int constraint_count);

  // What stood in the file when it was opened.
  const std::vector<SearchStep>& steps() const { return steps_; }

  void Append(const SearchStep& step);

 private:
  std::filesystem::path file_;
  std::vector<SearchStep> steps_;
  std::ofstream stream_;
};

}  // namespace lacuna

#endif  // LACUNA_SEARCH_EVALUATION_LOG_H_
