// The full result of each evaluation of a parameter search, of which the search itself sees one
// number.
//
// A line is written before the search's own log receives the evaluation, so that every evaluation
// in the log is in the record too. An incomplete last line, as a crash may leave it, is dropped.
// Each line has a hash of its content without the wall time.
#ifndef LACUNA_PAPER_EVALUATION_RECORD_H_
#define LACUNA_PAPER_EVALUATION_RECORD_H_

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "paper/parameter_objective.h"

namespace lacuna {

nlohmann::json ToJson(const SearchedParameters& parameters);
SearchedParameters SearchedParametersFrom(const nlohmann::json& json);
nlohmann::json ToJson(const ObjectiveEvaluation& evaluation);

class EvaluationRecord {
 public:
  // Opens or begins the record of the objective named by `key`. Throws InputError naming the file
  // when it cannot be written, is damaged, or belongs to another objective.
  EvaluationRecord(const std::filesystem::path& file, const std::string& key);

  // The evaluation of these parameters; null where there is none.
  const ObjectiveEvaluation* Find(const SearchedParameters& parameters) const;
  // Throws InputError when the file cannot be written.
  void Append(const SearchedParameters& parameters, const ObjectiveEvaluation& evaluation);

 private:
  void AppendLine(nlohmann::json line);  // and its hash

  std::filesystem::path file_;
  std::map<std::string, ObjectiveEvaluation> known_;
};

}  // namespace lacuna

#endif  // LACUNA_PAPER_EVALUATION_RECORD_H_
