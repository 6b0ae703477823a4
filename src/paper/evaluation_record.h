// What each evaluation of an outer search measured, beside the one number that the search sees.
//
// A line is written before the search's own log learns of the evaluation, so that whatever stands
// in the log stands here; a last line torn by a crash is dropped.
#ifndef LACUNA_PAPER_EVALUATION_RECORD_H_
#define LACUNA_PAPER_EVALUATION_RECORD_H_

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "paper/parameter_objective.h"

namespace lacuna {

nlohmann::json ToJson(const OuterParameters& parameters);
OuterParameters OuterParametersFrom(const nlohmann::json& json);
nlohmann::json ToJson(const OuterEvaluation& evaluation);

class EvaluationRecord {
 public:
  // Opens or begins the record of the objective named by `key`. Throws InputError naming the file
  // when it cannot be written, is damaged, or belongs to another objective.
  EvaluationRecord(const std::filesystem::path& file, const std::string& key);

  // Null where these parameters have not been evaluated.
  const OuterEvaluation* Find(const OuterParameters& parameters) const;
  void Append(const OuterParameters& parameters, const OuterEvaluation& evaluation);

 private:
  void AppendLine(const nlohmann::json& line);

  std::filesystem::path file_;
  std::map<std::string, OuterEvaluation> known_;
};

}  // namespace lacuna

#endif  // LACUNA_PAPER_EVALUATION_RECORD_H_
