#include "paper/table1.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/file_name.h"
#include "core/hash.h"
#include "experiment/kept_recording.h"
#include "paper/evaluation_record.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {
namespace {

constexpr double kTurnStep = 1e-3;    // rad, between one seed's mesh and the next
constexpr double kStartSpread = 0.1;  // share of a variable's range, either way
// Raised whenever a change of the code changes |D_anim| for the same recording: by the surfaces,
// the registration, the mesh, FollowFrames or the measures. kReferenceBodyVersion
// (experiment/reference_body_stage.cc), kStatesVersion and kMotionVersion
// (reconstruction/reconstruction.cc) are those of the same code in a reconstruction: a change of
// scans that raises one of them raises this one too.
constexpr int kObjectiveVersion = 4;
constexpr double kFactors[] = {0.25, 0.5, 1, 2, 4};

// The recording of a seed, and the scene's motion where one has to be scanned.
class Recordings {
 public:
  Recordings(const Table1Study& study, std::filesystem::path output, Progress* progress)
      : study_(study), output_(std::move(output)), progress_(progress) {}

  std::filesystem::path Folder(int seed) {
    const std::filesystem::path folder = output_ / fmt::format("seed_{}", seed) / "recording";
    const std::string key = RecordingKey(study_, seed);
    if (IsKeptRecording(folder, key)) return folder;
    if (!motion_) motion_ = SimulateWholeScene(study_.scene, progress_);
    Scene scene = study_.scene;
    scene.scanner->options.seed += static_cast<uint64_t>(seed) - 1;
    KeepRecording(scene, *motion_, folder, key);
    return folder;
  }

 private:
  const Table1Study& study_;
  std::filesystem::path output_;
  Progress* progress_;
  std::optional<SceneMotion> motion_;
};

// Seed 1 starts where the file says, others nearby.
ParameterSearchSettings SettingsOf(const Table1Configuration& configuration, int seed) {
  ParameterSearchSettings settings = configuration.search;
  if (seed == 1) return settings;
  settings.seed += static_cast<uint64_t>(seed) - 1;
  std::mt19937_64 random(static_cast<uint64_t>(seed));
  const SearchSpace space(settings.variables);
  Eigen::VectorXd start(settings.variables.size());
  for (size_t i = 0; i < settings.variables.size(); ++i)
    start[static_cast<Eigen::Index>(i)] = settings.variables[i].start;
  Eigen::VectorXd unit = space.ToUnit(start);
  for (double& u : unit) {
    const double share = static_cast<double>(random() >> 11) * 0x1p-53;
    u = std::clamp(u + kStartSpread * (2 * share - 1), 0.0, 1.0);
  }
  start = space.FromUnit(unit);
  for (size_t i = 0; i < settings.variables.size(); ++i) {
    SearchVariable& variable = settings.variables[i];
    if (variable.lower < variable.upper) variable.start = start[static_cast<Eigen::Index>(i)];
  }
  return settings;
}

// All that decides the objective, and what is kept of an evaluation.
std::string KeyOf(const ReconstructionStudy& study, const ParameterSearchSettings& settings,
                  const std::string& recording_key) {
  nlohmann::json options = study.configuration;
  for (const char* key :
       {"output", "name", "row", "paper_drop", "search", "varies", "question", "against"})
    options.erase(key);
  const bool has_slopes = settings.method == SearchMethod::kCeres;
  return HashBytes(fmt::format("{} {} {} {} {} {} {}", kObjectiveVersion, options.dump(),
                               recording_key, static_cast<int>(settings.measure),
                               settings.registration_in_loop, settings.remesh_surface, has_slopes));
}

// An evaluation beside a search, made once. `key` is that of the search's objective, of which the
// file's name says what was changed.
ObjectiveEvaluation Kept(const ParameterObjective& problem, const SearchedParameters& parameters,
                         const std::filesystem::path& file, const std::string& key) {
  EvaluationRecord record(file, key + " " + file.filename().string());
  return record.FindOrEvaluate(problem, parameters);
}

SearchedParameters TruthOf(const Table1Study& study, const Table1Configuration& configuration) {
  const std::vector<SearchVariable>& variables = configuration.search.variables;
  return {variables[0].start, variables[1].start, study.true_young_modulus,
          study.true_poisson_ratio};
}

void RefuseOtherScans(const Table1Configuration& configuration, const nlohmann::json& first,
                      const nlohmann::json& other) {
  for (const char* key : {"frames", "filter", "surface", "registration"}) {
    if (first.value(key, nlohmann::json()) != other.value(key, nlohmann::json()))
      configuration.config.Fail(key, "differs from that of the first row");
  }
}

// What a gradient through a remesh would be: difference quotients over the mesh's parameters.
std::vector<MeshQuotient> QuotientsOf(const ParameterObjective& problem,
                                      const Table1Configuration& configuration,
                                      const std::vector<double>& steps,
                                      const std::filesystem::path& file, const std::string& key,
                                      Progress* progress) {
  const SearchSpace space(configuration.search.variables);
  const Eigen::VectorXd start = space.ProblemOf({}).start;
  std::vector<MeshQuotient> quotients;
  progress->Begin("remeshing", static_cast<int64_t>(2 * steps.size()));
  for (const Eigen::Index i : {0, 1}) {
    const SearchVariable& variable = configuration.search.variables[static_cast<size_t>(i)];
    for (const double step : steps) {
      Eigen::VectorXd below = start, above = start;
      below[i] = std::max(start[i] - step, 0.0);
      above[i] = std::min(start[i] + step, 1.0);
      if (variable.lower == variable.upper) continue;
      const ObjectiveEvaluation from =
          Kept(problem, ParametersOf(space.FromUnit(below)), file, key);
      const ObjectiveEvaluation to = Kept(problem, ParametersOf(space.FromUnit(above)), file, key);
      const ObjectiveMeasure measure = configuration.search.measure;
      quotients.push_back(
          {variable.name, step,
           (ValueOf(to, measure) - ValueOf(from, measure)) / (above[i] - below[i])});
      progress->Report(static_cast<int64_t>(quotients.size()));
    }
  }
  progress->End();
  return quotients;
}

// Computed for the first seed only.
void RunFirstSeedExtras(const Table1Study& study, const Table1Options& options,
                        const ParameterObjective& problem, const std::filesystem::path& folder,
                        const std::string& key, Table1Result* result, Progress* progress) {
  const SearchedParameters truth = TruthOf(study, study.configurations.front());
  progress->Begin("mesh noise", options.turns);
  for (int k = 0; k < options.turns; ++k) {
    ParameterObjective turned = problem;
    turned.turn = kTurnStep * k;
    result->turned.push_back(Kept(turned, truth, folder / fmt::format("turn_{}.jsonl", k), key));
    progress->Report(k + 1);
  }
  progress->End();
  if (!options.difference_steps.empty()) {
    result->quotients = QuotientsOf(problem, study.configurations.front(), options.difference_steps,
                                    folder / "quotients.jsonl", key, progress);
  }
  if (!options.profile) return;
  ReconstructionStudy known_study = problem.study;
  known_study.follow.forces.kind = ForceSettings::Kind::kKnown;
  const ParameterObjective known{
      known_study, problem.states, problem.tracked, problem.remesh_surface, false, 0};
  progress->Begin("modulus", std::size(kFactors));
  for (const double factor : kFactors) {
    SearchedParameters at = truth;
    at.young_modulus *= factor;
    ModulusPoint point{factor, Kept(problem, at, folder / "modulus_fitted.jsonl", key), {}};
    if (!problem.study.recording.object.forces.empty())
      point.known = Kept(known, at, folder / "modulus_known.jsonl", key);
    result->profile.push_back(point);
    progress->Report(static_cast<int64_t>(result->profile.size()));
  }
  progress->End();
}

void RunSeed(const Table1Study& study, const Table1Options& options, int seed,
             const std::filesystem::path& recording_folder, Table1Result* result,
             Progress* progress) {
  const std::filesystem::path folder = options.output / fmt::format("seed_{}", seed);
  const Recording recording = LoadRecording(recording_folder);
  const ReconstructionStudy first =
      ReadReconstruction(study.configurations.front().config, recording);
  const std::vector<FrameState> states = LoadFrameStates(first, progress);
  const TrackedFrames tracked = TrackFrames(first, states, progress);
  Table1Seed outcome;
  outcome.seed = seed;
  for (const Table1Configuration& configuration : study.configurations) {
    const ReconstructionStudy reconstruction = ReadReconstruction(configuration.config, recording);
    RefuseOtherScans(configuration, first.configuration, reconstruction.configuration);
    const ParameterSearchSettings settings = SettingsOf(configuration, seed);
    ParameterObjective problem{reconstruction,
                               states,
                               tracked,
                               settings.remesh_surface,
                               settings.registration_in_loop,
                               kTurnStep * (seed - 1)};
    const std::filesystem::path place = folder / configuration.name;
    const std::string key = KeyOf(reconstruction, settings, RecordingKey(study, seed));
    Table1Search search;
    search.found = RunParameterSearch(problem, settings, place, key, progress);
    search.worst = search.found.Worst(settings.measure);
    search.at_truth = Kept(problem, TruthOf(study, configuration), place / "truth.jsonl", key);
    if (seed == options.first_seed) {
      if (&configuration == &study.configurations.front())
        RunFirstSeedExtras(study, options, problem, folder, key, result, progress);
      if (options.in_loop && search.found.IsUsable()) {
        problem.registration_in_loop = true;
        const auto& at = search.found.parameters;
        search.worst_in_loop = Kept(problem, at[search.worst], place / "in_loop.jsonl", key);
        search.best_in_loop = Kept(problem, at[search.found.best], place / "in_loop.jsonl", key);
      }
    }
    outcome.searches.push_back(std::move(search));
  }
  result->seeds.push_back(std::move(outcome));
}

// What the scene's recordings will be, as far as an experiment can be checked against it.
Recording AnnouncedRecording(const Scene& scene) {
  Recording recording;
  recording.name = scene.name;
  recording.object.density = scene.density;
  for (int k = 0; k < scene.frames; ++k) recording.times.push_back(k / scene.frame_rate);
  const Eigen::Vector2d covered(recording.times.front(), recording.times.back());
  for (const SceneLoad& load : scene.loads)
    if (load.measured)
      recording.object.forces.push_back(
          {load.region.name, load.region, covered, Eigen::Matrix3Xd::Zero(3, 2), {}});
  return recording;
}

}  // namespace

Table1Study ReadTable1(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError(SourcePosition{folder.string()}, "expected a folder of experiment files");
  std::vector<std::pair<int, std::filesystem::path>> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    files.emplace_back(Config::Load(entry.path()).Integer("row", 1, 1000), entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw InputError(SourcePosition{folder.string()}, "holds no .yaml file");

  std::vector<Config> configs;
  for (const auto& [row, file] : files) configs.push_back(Config::Load(file));
  return ReadTable1(configs);
}

Table1Study ReadTable1(const std::vector<Config>& files) {
  CHECK(!files.empty());
  Table1Study study;
  std::filesystem::path scene_file;
  for (const Config& config : files) {
    if (config.Has("row")) config.Integer("row", 1, 1000);
    Table1Configuration configuration{
        config.Text("name"), config, ReadParameterSearch(config.Child("search")), {}};
    // A search lies in a folder of that name, beside the recording.
    if (configuration.name != FileNameFor(configuration.name) || configuration.name == "recording")
      config.Fail("name",
                  "must consist of letters, digits and _ - + ., not begin with a dot, and not be "
                  "\"recording\"");
    if (config.Has("paper_drop"))
      configuration.paper_drop = config.Number("paper_drop", {0, 1, false, false});
    configuration.varies = config.Text("varies", "");
    configuration.question = config.Text("question", "");
    configuration.against = config.Text("against", "");
    for (const Table1Configuration& other : study.configurations)
      if (other.name == configuration.name)
        config.Fail("name", "is that of another file in the folder");
    const std::filesystem::path scene = std::filesystem::weakly_canonical(config.Path("scene"));
    if (!scene_file.empty() && scene != scene_file)
      config.Fail("scene", "differs from that of " + files.front().File().string());
    scene_file = scene;
    study.configurations.push_back(std::move(configuration));
  }
  const Config scene = Config::Load(scene_file);
  study.scene = ReadScene(scene);
  if (!study.scene.scanner) scene.Fail("", "has no scanner to make recordings with");
  study.scene_key = HashBytes(scene.Resolved().dump());
  const Config material = scene.Child("material");
  study.true_young_modulus = material.Quantity("young_modulus", kPressure, kPositive);
  study.true_poisson_ratio = material.Number("poisson_ratio", kAnyValue);
  const Recording announced = AnnouncedRecording(study.scene);
  for (const Config& config : files) ReadReconstruction(config, announced);
  return study;
}

std::string RecordingKey(const Table1Study& study, int seed) {
  return fmt::format("{} {} {}", kSceneVersion, study.scene_key, seed);
}

Table1Result RunTable1(const Table1Study& study, const Table1Options& options, Progress* progress) {
  MakeFolder(options.output);
  const std::filesystem::path claimed = options.output / ".claimed";
  const Claim claim(claimed);
  if (!claim.holds())
    throw InputError({options.output.string()}, "is being worked on by " + HolderOf(claimed));
  RemoveLeftTemporaries(options.output);
  Recordings recordings(study, options.output, progress);
  Table1Result result;
  for (int seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed)
    RunSeed(study, options, seed, recordings.Folder(seed), &result, progress);
  return result;
}

}  // namespace lacuna
