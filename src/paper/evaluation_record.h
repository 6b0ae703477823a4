// The full result of each evaluation of a parameter search, of which the search itself sees one
// number.
//
// A line is written before the search's own log receives the evaluation, so that every evaluation
// in the log is in the record too. An incomplete last line, as a crash may leave it, is dropped.
// Each line has a hash of its content without the wall time, and the vector instructions with which
// the evaluation was made. A record that is removed, or has lost lines, is filled again by
// FindOrEvaluate.
#ifndef LACUNA_PAPER_EVALUATION_RECORD_H_
#define LACUNA_PAPER_EVALUATION_RECORD_H_

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "paper/parameter_objective.h"

namespace lacuna {

nlohmann::json ToJson(const SearchedParameters& parameters);
SearchedParameters SearchedParametersFrom(const nlohmann::json& json);
nlohmann::json ToJson(const ObjectiveEvaluation& evaluation);

// The vector instructions that registration (registration/gaussian_sums.h) and OpenBLAS use on this
// processor, such as "AVX2, Haswell". Others round differently, so that the same evaluation has
// another value there: docs/sweep.md says by how much.
std::string InstructionsInUse();

class EvaluationRecord {
 public:
  // Opens or begins the record of the objective named by `key`. `instructions` are noted with the
  // evaluations that are appended. Throws InputError naming the file, which is then to be removed,
  // when it is damaged or belongs to another objective, and when it cannot be written.
  EvaluationRecord(const std::filesystem::path& file, const std::string& key,
                   const std::string& instructions = InstructionsInUse());

  // The evaluation of these parameters; null where there is none.
  const ObjectiveEvaluation* Find(const SearchedParameters& parameters) const;
  // Throws InputError when the file cannot be written.
  void Append(const SearchedParameters& parameters, const ObjectiveEvaluation& evaluation);
  // The evaluation of these parameters, which is made and appended where there is none. Throws what
  // EvaluateObjective and Append throw.
  const ObjectiveEvaluation& FindOrEvaluate(const ParameterObjective& problem,
                                            const SearchedParameters& parameters);

  // Other instructions than those of this record with which evaluations in it were made.
  const std::set<std::string>& other_instructions() const { return other_instructions_; }

 private:
  void Read(const std::string& text, const std::string& key);
  void AppendLine(nlohmann::json line);  // and its hash

  std::filesystem::path file_;
  std::string instructions_;
  std::set<std::string> other_instructions_;
  std::map<std::string, ObjectiveEvaluation> known_;
};

}  // namespace lacuna

#endif  // LACUNA_PAPER_EVALUATION_RECORD_H_
