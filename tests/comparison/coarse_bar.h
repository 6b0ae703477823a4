// Models of the held bar (support/held_bar.h) that are coarser than the truth.
#ifndef LACUNA_TESTS_COMPARISON_COARSE_BAR_H_
#define LACUNA_TESTS_COMPARISON_COARSE_BAR_H_

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "calibration/calibration_run.h"
#include "core/config.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"

namespace lacuna {

// The experiment in `folder` with the stiffness and the damping of HeldBarTruth, which are not
// fitted, and with longer time steps.
inline PredictionStudy ReadCoarseBarStudy(const std::filesystem::path& folder) {
  return ReadBarStudy(folder, {{"fit: {parameters: [{name: young_modulus}, {name: "
                                "mass_damping.alpha}]}",
                                "fit: {parameters: []}"},
                               {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
                               {"alpha: 1 1/s", "alpha: 2 1/s"},
                               {"motion: {time_step: 1.5 ms}", "motion: {time_step: 2 ms}"}});
}

// Predicts the recordings in `folder` with the stiffness of the truth and a mass damping of 1 1/s,
// by time steps of this length as YAML has it, into <folder>/run. Returns whether that was usable.
inline bool RunBarWithLittleDamping(const std::filesystem::path& folder,
                                    const std::string& time_step) {
  const std::filesystem::path experiment = folder / "study.yaml";
  std::ofstream(experiment) << BarExperiment(
      folder, {{"name: bar\nmesh", "name: bar\noutput: run\nmesh"},
               {"{name: young_modulus}, {name: mass_damping.alpha}", ""},
               {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
               {"motion: {time_step: 1.5 ms}", "motion: {time_step: " + time_step + "}"}});
  SilentProgress progress;
  return RunCalibration(ReadPredictionStudy(Config::Load(experiment)), &progress).usable;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_COMPARISON_COARSE_BAR_H_
