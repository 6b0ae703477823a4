// The folder of a made-up run of `lacuna fit`, as a report finds it: a bar with two markers, whose
// model lacks drag.
#ifndef LACUNA_TESTS_SUPPORT_SMALL_RUN_H_
#define LACUNA_TESTS_SUPPORT_SMALL_RUN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "record/ledger.h"
#include "record/motion_record.h"

namespace lacuna {

struct SmallRun {
  std::string name = "bar";
  double young_modulus = 1e5;  // Pa, in the configuration
  int held_out_frames = 10;
  std::string marker = "tip";             // the name of the second marker
  std::string content = "1f2e3d";         // hash of the recording
  std::vector<std::string> effects = {};  // of the model, in the configuration
  std::vector<double> sigmas = {};        // m, noise of each marker; empty: the table has none
};

// Writes manifest.json, calibration and its misfit, and the motion of SmallMotion().
void WriteSmallFit(const std::filesystem::path& folder, const SmallRun& run,
                   const CalibrationRecord& record);
// Adds a comparison that names the markers, and a diagnosis.
void WriteSmallComparison(const std::filesystem::path& folder, const SmallRun& run);
void WriteSmallDiagnosis(const std::filesystem::path& folder, const DiagnosisRecord& diagnosis);
// Both models of SmallLedger() in <folder>/bar and <folder>/bar+drag, with the ledger in the first.
void WriteSmallChain(const std::filesystem::path& folder);

// The motion of a triangle for the recording "a".
MotionRecord SmallMotion();

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_SMALL_RUN_H_
