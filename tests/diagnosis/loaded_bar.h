// A slow experiment: a bar that is loaded and unloaded in steps, in equilibrium in every frame.
#ifndef LACUNA_TESTS_DIAGNOSIS_LOADED_BAR_H_
#define LACUNA_TESTS_DIAGNOSIS_LOADED_BAR_H_

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "fem/effect.h"
#include "prediction/prediction_study.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {

class LoadedBar : public testing::Test {
 protected:
  static constexpr int kLoads = 16;        // frames, one a second
  static constexpr double kModulus = 9e4;  // Pa
  static constexpr double kRatio = 0.42;
  static constexpr double kNoise = 2e-5;  // m

  // A bed under a part of the bar.
  static std::shared_ptr<const Effect> BedBelow();

  // Records a bar with effects that the model lacks. `reading`: of the load cell, per newton. The
  // rest is that of Experiment().
  PredictionStudy Record(const std::vector<std::shared_ptr<const Effect>>& hidden,
                         const std::string& more = "", const std::string& effects = "",
                         double reading = 1);

  // Reads an experiment with the recording in the folder. `more`: further lines; `effects`: of the
  // model, besides gravity, each after a comma.
  PredictionStudy Experiment(const std::string& more, const std::string& effects = "") const;

  // With two refits, on a coarse mesh.
  Diagnosis FitAndDiagnose(PredictionStudy* study);

  TemporaryFolder folder_;
  SilentProgress progress_;

 private:
  // Markers of the bar in each frame; its material besides what is hidden is neo-Hookean.
  static std::vector<Eigen::Matrix3Xd> Film(
      const std::vector<std::shared_ptr<const Effect>>& hidden);
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_DIAGNOSIS_LOADED_BAR_H_
