// The page of a report: one HTML file that needs nothing else.
#ifndef LACUNA_REPORT_REPORT_PAGE_H_
#define LACUNA_REPORT_REPORT_PAGE_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// src/report/page/template.html as it was when the program was built.
std::string_view ReportTemplate();

// The template with the document in the place of its placeholder (src/report/page/README.md). The
// document is written in ASCII with every "<" as \u003c, so that no text in it can end the script
// element that holds it. Throws InputError unless the template has exactly one placeholder.
std::string ReportPage(std::string_view page_template, const nlohmann::json& document);

// The files that belong to a report: the page, and beside it its numbers.
struct ReportFiles {
  std::filesystem::path page, numbers;  // "report.html", "report_numbers.json"
};
ReportFiles FilesOf(const std::filesystem::path& page);
// Where the report of these runs is written unless the user says otherwise: in the folder of a
// single run, or beside the first of several, as A_vs_B.html. Throws InputError where that name
// would be too long.
ReportFiles DefaultReportFiles(const std::vector<std::filesystem::path>& runs);

// Gathers the runs (report_document.h) and writes both files, each atomically. The same folders
// give the same bytes. Returns the document. Throws InputError as ReportDocument does, and where a
// file cannot be written.
nlohmann::json WriteReport(const std::vector<std::filesystem::path>& runs,
                           const ReportFiles& files);

}  // namespace lacuna

#endif  // LACUNA_REPORT_REPORT_PAGE_H_
