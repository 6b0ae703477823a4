// Everything that a report shows of one or several runs, gathered from their folders as the JSON
// document of src/report/page/README.md.
#ifndef LACUNA_REPORT_REPORT_DOCUMENT_H_
#define LACUNA_REPORT_REPORT_DOCUMENT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace lacuna {

// Reads the folders of runs of `lacuna fit` or `reconstruct`, or of the results of `table1`,
// `ablation`, `lacuna-trials report` or `lacuna-trials intervals`; at least one (CHECK).
// Nothing is computed, and the same folders give the same document. Throws InputError when a folder
// is no finished run, when a file is damaged, or when several runs are not of one kind or have
// errors that cannot be compared (run_differences.h).
nlohmann::json ReportDocument(const std::vector<std::filesystem::path>& runs);

// The document without its packed arrays: the numbers, for other programs.
nlohmann::json WithoutPackedArrays(const nlohmann::json& document);

}  // namespace lacuna

#endif  // LACUNA_REPORT_REPORT_DOCUMENT_H_
