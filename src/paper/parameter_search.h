// The search for the (q, v, y, p) of least |D_anim|, which can be stopped at any evaluation.
#ifndef LACUNA_PAPER_PARAMETER_SEARCH_H_
#define LACUNA_PAPER_PARAMETER_SEARCH_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "paper/parameter_objective.h"
#include "search/cobyla.h"
#include "search/search_space.h"

namespace lacuna {

enum class OuterMethod {
  kCobylaModern,
  kCobylaPowell,
  kGaussianProcess,
  kNloptCobyla,
  kNloptBobyqa,
  kCeres  // along the gradient: of the equations by y and p where no forces are fitted, else
          // differences differences
};
enum class OuterMeasure {
  kPerPoint,  // over a fixed sampling of the surface: does not see how many points a mesh has
  kSum,       // the paper's sum over the mesh's own points: the fewer, the less
  kRms,       // the root of the mean square over that sampling: what lies far off counts more
};

struct OuterSearchSettings {
  std::vector<SearchVariable> variables;  // q, v, y, p; fixed where lower == upper
  OuterMethod method = OuterMethod::kCobylaModern;
  OuterMeasure measure = OuterMeasure::kPerPoint;
  bool registration_in_loop = false;
  bool remesh_surface = true;  // OuterProblem
  int evaluations = 40;        // at most
  CobylaOptions cobyla;
  double difference = 0.1;  // of kCeres, in parts of a range (fit/gradient_search.h)
  uint64_t seed = 1;        // of the Gaussian process's candidates
};

// The mapping `search` of an experiment; docs/search.md lists its keys.
OuterSearchSettings ReadOuterSearch(const Config& search);

OuterParameters ParametersOf(const Eigen::VectorXd& x);  // q, v, y, p
double ValueOf(const OuterEvaluation& evaluation, OuterMeasure measure);

struct OuterSearchResult {
  SearchStatus status = SearchStatus::kNotRun;
  std::string message;
  std::string trace_hash;                    // equal for equal searches
  std::vector<OuterParameters> parameters;   // of each evaluation, in order
  std::vector<OuterEvaluation> evaluations;  // likewise
  int best = -1;                             // index of the least value; -1: all failed
  int failures = 0;

  bool IsUsable() const { return best >= 0; }
  double Seconds() const;  // of all evaluations, those of stopped runs included
  // The evaluation of the largest value, which is where the paper's drops are counted from.
  int Worst(OuterMeasure measure) const;
};

// Keeps search.log and evaluations.jsonl in `folder` (made where it is absent) and goes on from
// them. `key` names all that decides the objective: files of another one are an InputError. Throws
// Interrupted with every finished evaluation kept.
OuterSearchResult RunOuterSearch(const OuterProblem& problem, const OuterSearchSettings& settings,
                                 const std::filesystem::path& folder, const std::string& key,
                                 Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_PARAMETER_SEARCH_H_
