// Table 1 of Transue & Choi 2015: the reduction of |D_anim| when the geometry (q, v), the material
// (y, p) or all four parameters are searched, and controls that show how much of the reduction is
// real.
//
// The recording is synthetic: it can be repeated with other noise, and the true moduli are known.
// Each seed has another scan of the same motion, another start and another mesh at the same
// parameters (the input of TetGen is rotated by a small angle).
#ifndef LACUNA_PAPER_TABLE1_H_
#define LACUNA_PAPER_TABLE1_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "experiment/scene.h"
#include "paper/parameter_search.h"

namespace lacuna {

// One of the experiment files: a reconstruction without recording, a scene and a search.
struct Table1Configuration {
  std::string name;
  Config config;
  ParameterSearchSettings search;
  std::optional<double> paper_drop;  // the reduction of |D_anim| in the paper, a fraction
  // For an ablation (paper/ablation.h): what varies, the question, and the row to compare with.
  std::string varies = {}, question = {}, against = {};
};

struct Table1Study {
  std::vector<Table1Configuration> configurations;  // in the order of the files' `row`
  Scene scene;
  std::string scene_key;  // a hash of everything that determines its motion and scans
  double true_young_modulus = 0, true_poisson_ratio = 0;
};
// The key of the recording of a seed (experiment/kept_recording.h), with the version of the code
// that makes it.
std::string RecordingKey(const Table1Study& study, int seed);

// Reads all .yaml files in `folder`. Throws InputError for a file that cannot be used, and when two
// files name different scenes.
Table1Study ReadTable1(const std::filesystem::path& folder);
// ReadTable1() for files that are loaded already, in this order; `row` may be absent.
Table1Study ReadTable1(const std::vector<Config>& files);

struct Table1Options {
  std::filesystem::path output = "results/table1";
  int first_seed = 1;
  int seeds = 1;  // the number of seeds, from first_seed on
  // The following controls are computed for the first seed only.
  int turns = 8;        // rotated meshes for an estimate of the mesh noise; 0: none
  bool profile = true;  // |D_anim| as a function of the modulus, with forces fitted and known
  bool in_loop = true;  // the ends of each search evaluated again with CPD in the loop
  // Steps of difference quotients over q and v at the start of the first configuration, as
  // fractions of a range.
  std::vector<double> difference_steps = {};
};

// The search of one configuration and seed, with its ends measured as in the paper.
struct Table1Search {
  ParameterSearchResult found;
  int worst = -1;  // index of the largest value
  // Both ends evaluated again with CPD in the loop; first seed only.
  ObjectiveEvaluation worst_in_loop, best_in_loop;
  ObjectiveEvaluation at_truth;  // at the q and v of the file and the true y and p
};

struct Table1Seed {
  int seed = 1;
  std::vector<Table1Search> searches;  // one a configuration
};

struct ModulusPoint {
  double factor = 1;                  // multiple of the true modulus
  ObjectiveEvaluation fitted, known;  // forces fitted, as in the searches; forces as measured
};

// (P(x + h e) − P(x − h e)) / 2h, where both ends have meshes of their own.
struct MeshQuotient {
  std::string variable;
  double step = 0;              // h, as a fraction of the range
  double slope = kNotMeasured;  // m per range; not measured where an end failed
};

struct Table1Result {
  std::vector<Table1Seed> seeds;
  std::vector<ObjectiveEvaluation>
      turned;  // at the true parameters, with S_0 rotated in small steps
  std::vector<ModulusPoint> profile;
  std::vector<MeshQuotient> quotients;
};

// Makes missing recordings and resumes searches that were stopped. Throws Interrupted, and
// InputError where the configurations process the scans differently, as surfaces and registrations
// are computed once for all configurations.
Table1Result RunTable1(const Table1Study& study, const Table1Options& options, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_H_
