// The measured forces and torques of grips as a report's page draws them: the Curves of
// src/report/page/README.md.
#ifndef LACUNA_REPORT_REACTION_CURVES_H_
#define LACUNA_REPORT_REACTION_CURVES_H_

#include <filesystem>
#include <nlohmann/json.hpp>

#include "record/calibration_record.h"
#include "record/csv_table.h"

namespace lacuna {

// reactions.csv and torques.csv of a fit (calibration/reaction_report.h); empty where they are
// absent.
struct ReactionTables {
  std::filesystem::path folder;
  CsvTable forces, torques;
};
ReactionTables ReadReactionTables(const std::filesystem::path& calibration);

// All components of all readings of recording number `r`, which is `recording`: forces, then
// torques. An empty list where none is measured. Throws InputError when the tables and the
// recording do not belong together.
nlohmann::json ReactionCurves(const ReactionTables& tables, size_t r,
                              const FittedRecording& recording);

}  // namespace lacuna

#endif  // LACUNA_REPORT_REACTION_CURVES_H_
