#include "plan/planned_experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/atomic_file.h"
#include "core/changed_yaml.h"
#include "core/error.h"
#include "core/file_name.h"
#include "core/quoted_text.h"
#include "effects/effect_text.h"
#include "effects/uniform_density.h"
#include "experiment/listed_regions.h"
#include "geometry/mesh_io.h"
#include "plan/planned_recording.h"
#include "prediction/played_recording.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// The entry of the recording in the experiment `file`.
struct Entry {
  const PredictedRecording& item;
  std::string name;    // of the recording in the experiment
  std::string folder;  // of the recording, relative to the file
};

std::string Written(const Effect& effect) {
  if (const auto text = FormatEffect(effect)) return *text;
  throw InputError(fmt::format("{}: cannot be written down by the program", effect.Card().type));
}

std::string FormatHold(const Hold& hold) {
  std::string text =
      fmt::format("{{release: {} s, region: {}", hold.release, FormatRegion(hold.region));
  if (hold.force) text += ", force: " + FormatVector(*hold.force, "N");
  return text + "}";
}

std::string FormatEntry(const Entry& entry) {
  const PredictedRecording& item = entry.item;
  std::string text = fmt::format("{{name: {}, recording: {}", QuotedText(entry.name), entry.folder);
  if (item.clock_deviation > 0)
    text += fmt::format(", clock_deviation: {} s", item.clock_deviation);
  if (item.shift_deviation > 0)
    text += fmt::format(", registration: {{shift_deviation: {} m, turn_deviation: {} rad}}",
                        item.shift_deviation, item.turn_deviation);
  if (item.hold) text += ", hold: " + FormatHold(*item.hold);
  std::vector<std::string> effects;
  for (const auto& effect : item.effects) effects.push_back(Written(*effect));
  if (!effects.empty()) text += fmt::format(", effects: [{}]", fmt::join(effects, ", "));
  return text + "}";
}

// `name`, with a number behind it where a recording of the study has that name.
std::string UnusedName(const std::string& name, const PredictionStudy& study) {
  std::string unused = name;
  const auto is_taken = [&](const PredictedRecording& item) { return item.name == unused; };
  for (int number = 2; std::any_of(study.recordings.begin(), study.recordings.end(), is_taken);
       ++number)
    unused = fmt::format("{} {}", name, number);
  return unused;
}

std::string ChangedExperiment(const FittedRun& fitted, std::vector<YamlChange> changes,
                              const fs::path& file) {
  for (YamlChange& change : changes) change.file = file;
  return ChangedYaml(fitted.study.file, changes, {"output", "recording"}, file.parent_path());
}

// The fitted model with the planned recording alone.
void WriteProtocol(const FittedRun& fitted, const PredictionStudy& study, const Entry& entry,
                   const fs::path& file) {
  const EffectList fixed = WithDensityInBody(study.effects, study.density);
  std::vector<std::string> effects;
  for (size_t k = 1; k < fixed.size(); ++k) effects.push_back(Written(*fixed[k]));
  const double density = DensityWith(study.effects, study.density);
  std::vector<YamlChange> changes = {{"name", QuotedText(FileNameFor(entry.name)), {}},
                                     {"output", "simulated", {}},
                                     {"density", fmt::format("{} kg/m^3", density), {}},
                                     {"material", Written(*fixed.front()), {}},
                                     {"effects", fmt::format("[{}]", fmt::join(effects, ", ")), {}},
                                     {"noise", fmt::format("{} m", study.noise), {}},
                                     {"recordings", "[" + FormatEntry(entry) + "]", {}}};
  if (study.scheme != TimeScheme::kQuasiStatic)
    changes.push_back({"motion.time_step", fmt::format("{} s", study.time_step), {}});
  const std::string command =
      fmt::format("#   lacuna simulate {0} --recording {1}", file.generic_string(),
                  (file.parent_path() / "rehearsed").generic_string());
  WriteFileAtomically(
      file, fmt::format("# The next recording of {}, played with its fitted model:\n{}\n{}",
                        fitted.study.name, command, ChangedExperiment(fitted, changes, file)));
}

// The experiment of the run with the recording that is to be made.
void WriteJointExperiment(const FittedRun& fitted, const Entry& entry, const fs::path& file) {
  // Not with "+", which stands before an effect that was added to the model.
  const std::string name = fmt::format("{}-with-{}", fitted.study.name, FileNameFor(entry.name));
  const fs::path output = fs::absolute(fitted.study.output).lexically_normal().parent_path() / name;
  const fs::path from_file =
      output.lexically_proximate(fs::absolute(file.parent_path()).lexically_normal());
  const std::vector<YamlChange> changes = {{"name", QuotedText(name), {}},
                                           {"output", QuotedText(from_file.string()), {}},
                                           {"recordings[+]", FormatEntry(entry), {}}};
  WriteFileAtomically(
      file,
      fmt::format("# The experiment {0} with one more recording. Make it as {1}/recording.yaml\n"
                  "# describes it, and put it into the folder {2}: a copy of {1}, in which\n"
                  "# markers.csv and the other files are replaced by what was measured. Then\n"
                  "#   lacuna fit {3}\n{4}",
                  fitted.study.name, "predicted", entry.folder, file.generic_string(),
                  ChangedExperiment(fitted, changes, file)));
}

}  // namespace

fs::path FolderOf(const Protocol& protocol) { return FileNameFor(protocol.name); }

void WritePlannedExperiment(const FittedRun& fitted, double time_step, const Protocol& protocol,
                            const fs::path& folder) {
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  PredictionStudy study = problem.StudyAt(fitted.values);
  study.time_step = time_step;
  PlannedRecording planned = PlanRecording(protocol, study, fitted.mesh);
  for (size_t r = 0; r < study.recordings.size(); ++r)
    if (study.recordings[r].name == protocol.recording && planned.item.hold)
      planned.item.hold->force =
          PlannedHoldForce(protocol, problem.NuisanceOf(r, fitted.values).head<3>());

  const auto body = std::make_shared<const Body>(MakeBody(fitted.mesh, study.density));
  const RecordingModel model(study, planned.item, fitted.mesh, body, {});
  const PlayedRecording played = Play(model, PlayedNuisances(model));
  if (!played.summary.IsUsable())
    throw InputError(
        fmt::format("\"{}\" cannot be played: {}", protocol.name, played.summary.message));
  MakeFolder(folder);
  WriteTetMesh(folder / "object.msh", fitted.mesh);
  ListNodesOfMesh(fitted.mesh, RegionsIn(&planned.item));
  MarkerRecording recording = AsRecording(planned.item, played, /*noise=*/0, /*seed=*/0);
  recording.reference = folder / "object.msh";
  recording.comment =
      fmt::format("{}.\nPredicted by the fitted model of {}; nothing of it was measured.",
                  DescribeProtocol(protocol), fitted.study.name);
  const fs::path predicted = "predicted", measured = "measured";
  WriteMarkerRecording(folder / predicted, recording);
  const std::string name = UnusedName(protocol.name, fitted.study);
  WriteProtocol(fitted, study, {planned.item, name, predicted.string()}, folder / "protocol.yaml");
  WriteJointExperiment(fitted, {planned.item, name, measured.string()}, folder / "experiment.yaml");
}

}  // namespace lacuna
