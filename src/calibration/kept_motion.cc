#include "calibration/kept_motion.h"

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/interrupt.h"
#include "prediction/predicted_states.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

// Whether the file holds the motion of this fit. A damaged file, or one of another version, is
// written anew.
bool IsKept(const std::filesystem::path& file, const std::string& fit) {
  try {
    return std::filesystem::exists(file) && ReadMotionFile(file).fit == fit;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

void KeepMotion(const std::filesystem::path& run, Progress* progress) {
  const size_t recordings = ReadCalibration(run).recordings.size();
  const std::string fit = HashFile(FinishedStage(run, "calibration") / "calibration.json");
  bool are_kept = true;
  for (size_t r = 0; r < recordings; ++r) are_kept = are_kept && IsKept(MotionFile(run, r), fit);
  if (are_kept) return;
  const FittedRun fitted = OpenRun(run);
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  progress->Begin("motion", static_cast<int64_t>(recordings));
  for (size_t r = 0; r < recordings; ++r) {
    ThrowIfInterrupted();
    const RecordingModel model = problem.ModelAt(r, fitted.values);
    MotionRecord motion =
        ShownMotion(model, PredictStates(model, problem.NuisanceOf(r, fitted.values)));
    motion.fit = fit;
    MakeFolder(MotionFile(run, r).parent_path());
    WriteMotionFile(motion, MotionFile(run, r));
    progress->Report(static_cast<int64_t>(r) + 1);
  }
  progress->End();
}

}  // namespace lacuna
