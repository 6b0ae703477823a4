// The motion of one recording as a report's page draws and plots it: a Scene of
// src/report/page/README.md.
#ifndef LACUNA_REPORT_SCENE_DOCUMENT_H_
#define LACUNA_REPORT_SCENE_DOCUMENT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "report/reported_run.h"

namespace lacuna {

// The scenes of all recordings of a fitted model: its points and errors from misfit.csv, the
// surface from MotionFile(), the unexplained force from comparison/unexplained_force.csv, where
// these are of this fit, and the measured reactions of grips from reactions.csv and torques.csv.
// Throws InputError when one of the files is damaged.
nlohmann::json SceneDocuments(const ReportedModel& model);

// The scene of a reconstruction, from results/shown_motion.json; null where it has none.
nlohmann::json ReconstructionScene(const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_REPORT_SCENE_DOCUMENT_H_
