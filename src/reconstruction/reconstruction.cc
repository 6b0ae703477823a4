#include "reconstruction/reconstruction.h"

#include <algorithm>

#include "core/interrupt.h"
#include "experiment/frame_states.h"
#include "experiment/reference_body_stage.h"
#include "experiment/scan_settings.h"
#include "reconstruction/follow.h"
#include "reconstruction/known_answers.h"
#include "reconstruction/reconstruction_measures.h"
#include "reconstruction/recorded_states.h"
#include "reconstruction/shown_reconstruction.h"
#include "record/input_files.h"
#include "record/run_directory.h"
#include "record/run_stage.h"

namespace lacuna {
namespace {

// Incremented whenever a change of the code changes the result of the stage.
constexpr int kStatesVersion = 5;
constexpr int kMotionVersion = 9;
constexpr int kResultsVersion = 7;

InputFiles InputsOf(const ReconstructionStudy& study) {
  InputFiles inputs;
  for (const FileState& file : study.recording.files)
    inputs.Add(InputName(file.file, study.recording.file.parent_path()), file);
  return inputs;
}

// The known answers. Nothing that enters the results has been read of them yet.
InputFiles TruthOf(const ReconstructionStudy& study) {
  InputFiles truth;
  for (const auto& [name, file] : FilesOfKnownAnswers(study.validation, study.frames))
    truth.Add(name, StateOf(file));
  return truth;
}

}  // namespace

RunRecord RunReconstruction(const ReconstructionStudy& study, Progress* progress) {
  RunDirectory run(study.output);
  const InputFiles files = InputsOf(study);
  const std::map<std::string, std::string>& inputs = files.hashes();
  run.Begin(study.configuration, inputs, study.seed);
  run.Watch(files);
  const nlohmann::json& options = study.configuration;
  const auto part = [&options](std::initializer_list<const char*> keys) {
    nlohmann::json chosen = nlohmann::json::object();
    for (const char* key : keys)
      if (options.contains(key)) chosen[key] = options[key];
    return chosen;
  };

  const auto states = RunStage<std::vector<FrameState>>(
      &run,
      {"surfaces", kStatesVersion, part({"frames", "filter", "surface", "validation"}), inputs},
      progress, [&] { return LoadFrameStates(study, progress); }, WriteFrameStates,
      ReadFrameStates);

  std::map<std::string, std::string> behind{{"surfaces", run.ResultHash("surfaces")}};
  for (const auto& [name, hash] : inputs) behind[name] = hash;
  const ReferenceBody reference =
      RunReferenceBodyStage(&run, part({"mesh"}), behind, progress,
                            [&] { return MakeReferenceBody(study, states.front()); });

  behind["mesh"] = run.ResultHash("mesh");
  const auto motion = RunStage<FollowedMotion>(
      &run,
      {"motion", kMotionVersion,
       part({"material", "effects", "density", "motion", "forces", "fit", "registration"}), behind},
      progress, [&] { return FollowFrames(study, reference, states, progress); },
      WriteFollowedMotion,
      [&](const std::filesystem::path& folder) {
        return ReadFollowedMotion(study, reference, folder);
      });

  behind["motion"] = run.ResultHash("motion");
  const InputFiles truth = TruthOf(study);
  for (const auto& [name, hash] : truth.hashes()) behind[name] = hash;
  const auto record = RunStage<RunRecord>(
      &run, {"results", kResultsVersion, part({"name", "validation"}), behind}, progress,
      [&] {
        RunRecord measured = MeasureRun(study, reference, states, motion);
        truth.RequireUnchanged();
        return measured;
      },
      [&](const RunRecord& value, const std::filesystem::path& folder) {
        WriteRunRecord(value, folder);
        WriteFields(study, states, motion, folder);
        if (std::any_of(motion.frames.begin(), motion.frames.end(),
                        [](const FollowedFrame& frame) { return frame.solver.usable; }))
          WriteMotionFile(ShownReconstruction(study, states, motion), folder / "shown_motion.json");
      },
      ReadRunRecord);
  run.Finish();
  return record;
}

}  // namespace lacuna
