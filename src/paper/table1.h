// Table 1 of Transue & Choi 2015: how far |D_anim| falls when the geometry (q, v), the material
// (y, p) or all four parameters are searched; and, beside it, what in that is real.
//
// The recording is synthetic, so that it can be made again with other noise, and the true moduli
// are known. Each seed is another scan of the same motion, another start and another mesh at the
// same parameters (TetGen's input is turned by a small angle).
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
  OuterSearchSettings search;
  std::optional<double> paper_drop;  // of the paper's |D_anim|, a fraction
  // Of an ablation (paper/ablation.h): what varies, the question, and the row it is held against.
  std::string varies = {}, question = {}, against = {};
};

struct Table1Study {
  std::vector<Table1Configuration> configurations;  // in the order of the files' `row`
  Scene scene;
  std::string scene_key;  // hash of all that decides its motion and scans
  double true_young_modulus = 0, true_poisson_ratio = 0;
};
// Names the recording of a seed (experiment/kept_recording.h).
std::string RecordingKey(const Table1Study& study, int seed);

// Reads every .yaml file in `folder`. Throws InputError for a file that cannot be used, or when two
// of them name different scenes.
Table1Study ReadTable1(const std::filesystem::path& folder);
// The same of files that are loaded already, in this order; `row` may be absent.
Table1Study ReadTable1(const std::vector<Config>& files);

struct Table1Options {
  std::filesystem::path output = "results/table1";
  int first_seed = 1;
  int seeds = 1;        // so many, from first_seed on
  int turns = 8;        // meshes from which the first seed's mesh noise is told; 0: not asked
  bool profile = true;  // |D_anim| over the modulus, forces fitted and known, first seed
  bool in_loop = true;  // the ends of each search again with CPD in the loop, first seed
  // Steps, in parts of a range, of difference quotients over q and v at the first configuration's
  // start; first seed.
  std::vector<double> difference_steps = {};
};

// A search of one configuration and seed, with the paper's way of measuring its ends.
struct Table1Search {
  OuterSearchResult found;
  int worst = -1;  // index of the largest value met
  // Both again with CPD in the loop; first seed only.
  OuterEvaluation worst_in_loop, best_in_loop;
  OuterEvaluation at_truth;  // the file's q and v, the true y and p
};

struct Table1Seed {
  int seed = 1;
  std::vector<Table1Search> searches;  // one a configuration
};

struct ModulusPoint {
  double factor = 1;              // of the true modulus
  OuterEvaluation fitted, known;  // forces fitted, as in the searches; forces as measured
};

// (P(x + h e) − P(x − h e)) / 2h, both ends with meshes of their own.
struct MeshQuotient {
  std::string variable;
  double step = 0;              // h, in parts of the range
  double slope = kNotMeasured;  // m per range; not measured where an end failed
};

struct Table1Result {
  std::vector<Table1Seed> seeds;
  std::vector<OuterEvaluation> turned;  // the truth's parameters, S_0 turned a little more each
  std::vector<ModulusPoint> profile;
  std::vector<MeshQuotient> quotients;
};

// Makes the recordings that are not there yet, and goes on with searches that were stopped. Throws
// Interrupted, and InputError where the configurations treat the scans differently: they are
// cleaned, turned into surfaces and registered once for all.
Table1Result RunTable1(const Table1Study& study, const Table1Options& options, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_H_
