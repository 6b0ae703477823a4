// The search for the parameters (q, v, y, p) with the smallest |D_anim|. It can be stopped after
// any evaluation and resumed.
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

enum class SearchMethod {
  kCobylaModern,
  kCobylaPowell,
  kGaussianProcess,
  kNloptCobyla,
  kNloptBobyqa,
  kCeres  // gradient-based: analytic derivatives by y and p where no forces are fitted, else
          // finite differences
};
enum class ObjectiveMeasure {
  kPerPoint,  // the mean over a fixed sampling of the surface, independent of the mesh's vertices
  kSum,       // the paper's sum over the vertices of the mesh, which decreases with their number
  kRms,       // the rms over the fixed sampling, which gives large residuals more weight
};

struct ParameterSearchSettings {
  std::vector<SearchVariable> variables;  // q, v, y, p; fixed where lower == upper
  SearchMethod method = SearchMethod::kCobylaModern;
  ObjectiveMeasure measure = ObjectiveMeasure::kPerPoint;
  bool registration_in_loop = false;
  bool remesh_surface = true;  // ParameterObjective
  int evaluations = 40;        // the maximum
  CobylaOptions cobyla;
  double difference = 0.1;  // step of finite differences, as a fraction of a range
  uint64_t seed = 1;        // seed of the candidates of the Gaussian process
};

// Reads the mapping `search` of an experiment; docs/search.md lists its keys. Throws InputError.
ParameterSearchSettings ReadParameterSearch(const Config& search);

SearchedParameters ParametersOf(const Eigen::VectorXd& x);  // x holds q, v, y, p
double ValueOf(const ObjectiveEvaluation& evaluation, ObjectiveMeasure measure);

struct ParameterSearchResult {
  SearchStatus status = SearchStatus::kNotRun;
  std::string message;
  std::string trace_hash;                        // equal for equal searches
  std::vector<SearchedParameters> parameters;    // one per evaluation, in order
  std::vector<ObjectiveEvaluation> evaluations;  // their results
  int best = -1;                                 // index of the least value; -1: all failed
  int failures = 0;

  bool IsUsable() const { return best >= 0; }
  double Seconds() const;  // time of all evaluations, including those before an interruption
  // The evaluation of the largest value, which the reductions in the paper refer to.
  int Worst(ObjectiveMeasure measure) const;
};

// Keeps search.log and evaluations.jsonl in `folder`, which is made where necessary, and resumes
// from them. Without the log the search takes the same path again through the evaluations that are
// kept; evaluations that the record lacks are made again. `key` identifies the objective, and
// whether its slopes are kept: InputError where the files belong to another one or disagree. Warns
// where evaluations were made with other vector instructions. Throws Interrupted; all finished
// evaluations are kept.
ParameterSearchResult RunParameterSearch(const ParameterObjective& problem,
                                         const ParameterSearchSettings& settings,
                                         const std::filesystem::path& folder,
                                         const std::string& key, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_PARAMETER_SEARCH_H_
