// What a report takes from the folder of one run, whatever its kind.
#ifndef LACUNA_REPORT_GATHERED_RUN_H_
#define LACUNA_REPORT_GATHERED_RUN_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "record/csv_table.h"
#include "record/manifest.h"
#include "report/run_differences.h"

namespace lacuna {

// One run: its part of the document, and what a comparison with others needs.
struct GatheredRun {
  nlohmann::json document;  // `Run` of src/report/page/README.md
  std::vector<std::string> sentences;
  ComparableRun comparable;
};

// The part of the document for a run of this kind ("prediction", "reconstruction", "table1",
// "trials" or "intervals") with its name and folder and with all other keys, which are null or
// empty.
nlohmann::json EmptyRun(const std::filesystem::path& folder, const std::string& kind);

// Where the run comes from: program, libraries, configuration and inputs of the manifest, and the
// commands that make the run and its report.
nlohmann::json Provenance(const Manifest& manifest, const std::vector<std::string>& commands);

// A path as seen from the folder that contains results/NAME of the run, where commands are usually
// given, so that the document does not depend on where it is made.
std::string FromProject(const std::filesystem::path& path, const std::filesystem::path& run);

// {"column": [values], ...}.
nlohmann::json TableToJson(const CsvTable& table);

}  // namespace lacuna

#endif  // LACUNA_REPORT_GATHERED_RUN_H_
