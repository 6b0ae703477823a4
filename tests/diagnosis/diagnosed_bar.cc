#include "diagnosis/diagnosed_bar.h"

#include <gtest/gtest.h>

#include "calibration/calibration_fits.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {

Diagnosis DiagnoseBar(const HeldBarTruth& truth, const std::map<std::string, std::string>& replaced,
                      const DiagnosisOptions& options, const std::array<int, 3>& cells) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(folder.Path(), replaced);
  const TetMesh mesh = BarMesh(cells, 2);
  const CalibrationProblem problem(study, mesh);
  SilentProgress progress;
  const Calibration calibration = FitFromStart(problem, &progress);
  EXPECT_TRUE(calibration.usable) << calibration.message;
  return Diagnose(problem, calibration.parameters, options, &progress);
}

}  // namespace lacuna
