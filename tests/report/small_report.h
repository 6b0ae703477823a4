// What the tests of the report's document share: it is made of the runs of support/small_run.h.
#ifndef LACUNA_TESTS_REPORT_SMALL_REPORT_H_
#define LACUNA_TESTS_REPORT_SMALL_REPORT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "report/report_document.h"
#include "support/small_ledger.h"
#include "support/small_run.h"

namespace lacuna {

// Writes a run of the first model of SmallLedger().
inline void WriteFit(const std::filesystem::path& folder, const SmallRun& run) {
  CalibrationRecord record = SmallLedger().models[0].record;
  record.recordings[0].held_out.frames = run.held_out_frames;
  WriteSmallFit(folder, run, record);
}

// The only run of the document of this folder.
inline nlohmann::json ShownRun(const std::filesystem::path& run) {
  return ReportDocument({run}).at("runs").at(0);
}

// The scenes of its first model.
inline nlohmann::json ShownScenes(const std::filesystem::path& run) {
  return ShownRun(run).at("models").at(0).at("scenes");
}

// Why the document of these runs is refused; empty if it is not.
inline std::string WhyRefused(const std::vector<std::filesystem::path>& runs) {
  try {
    ReportDocument(runs);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_REPORT_SMALL_REPORT_H_
