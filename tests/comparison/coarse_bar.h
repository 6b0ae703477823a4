// Models of the held bar (support/held_bar.h) that are coarser than the truth, and what is expected
// of their comparison with the recordings.
#ifndef LACUNA_TESTS_COMPARISON_COARSE_BAR_H_
#define LACUNA_TESTS_COMPARISON_COARSE_BAR_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/calibration_run.h"
#include "comparison/compared_motion.h"
#include "comparison/run_comparison.h"
#include "comparison/unexplained_force.h"
#include "core/config.h"
#include "prediction/prediction_study_reader.h"
#include "record/comparison_record.h"
#include "record/motion_record.h"
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

// The comparison of a run with what was recorded, with all that needs the motion.
inline Comparison CompareWithMotion(const std::filesystem::path& run) {
  Comparison comparison = CompareRun(run);
  SilentProgress progress;
  CompareMotion(run, &progress, &comparison);
  return comparison;
}

// Rms over time of the error of one component of the net force, N.
inline double NetForceError(const ForceHistory& history, const HeldBarTruth& truth, int axis) {
  double squares = 0;
  for (Eigen::Index k = 0; k < history.times.size(); ++k)
    squares += std::pow(history.force(axis, k) - truth.body_force(history.times[k])[axis], 2);
  return std::sqrt(squares / static_cast<double>(history.times.size()));
}

// Expects the trends of the error that need the motion of the bar, and its strains.
inline void ExpectTrendsOfTheMotion(const ComparedRecording& bar) {
  for (const ComparedPart& part : bar.parts) {
    std::vector<std::string> quantities;
    for (const ErrorTrend& trend : part.trends) quantities.push_back(trend.quantity);
    EXPECT_THAT(quantities, testing::IsSupersetOf({"strain", "strain_rate_per_s", "height_m"}));
  }
  // A soft bar of 80 mm whose end hangs down by about 10 mm has surface strains of a few percent.
  const std::vector<ErrorBin>& strain = (bar.parts[0].trends.end() - 3)->bins;
  EXPECT_GT(strain.back().mean, 0.005);
  EXPECT_LT(strain.back().mean, 0.2);
}

// Expects that the motion which a run has stored for the report belongs to this fit, and that the
// last of its fields is the unexplained force, which is not zero.
inline void ExpectForceInMotion(const StoredMotion& motion, const std::string& fit) {
  EXPECT_EQ(motion.fit, fit);
  const nlohmann::json& field = motion.surface.at("fields").back();
  EXPECT_EQ(field.at("name"), "unexplained_force");
  EXPECT_GT(field.at("high").get<double>(), 0);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_COMPARISON_COARSE_BAR_H_
