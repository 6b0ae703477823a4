#include "report/report_page.h"

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "report/report_document.h"
#include "report/reported_run.h"

// The template, which report_template.S includes byte for byte.
extern "C" const char lacuna_report_template_begin[];
extern "C" const char lacuna_report_template_end[];

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view kPlaceholder =
    R"(<script type="application/json" id="report-data">{}</script>)";
constexpr std::string_view kEmpty = "{}";
constexpr size_t kLongestName = 200;  // file systems allow 255 bytes

// Names come from the user's files and need not be UTF-8; other bytes become U+FFFD.
std::string Dump(const json& document, int indent) {
  return document.dump(indent, ' ', /*ensure_ascii=*/true, json::error_handler_t::replace);
}

std::string WithoutAngles(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

}  // namespace

std::string_view ReportTemplate() {
  return {lacuna_report_template_begin,
          static_cast<size_t>(lacuna_report_template_end - lacuna_report_template_begin)};
}

std::string ReportPage(std::string_view page_template, const json& document) {
  const size_t at = page_template.find(kPlaceholder);
  if (at == std::string_view::npos || page_template.rfind(kPlaceholder) != at)
    throw InputError("the template of the report has no placeholder for its data, or several");
  const size_t data = at + kPlaceholder.find(kEmpty);
  std::string page(page_template.substr(0, data));
  page += WithoutAngles(Dump(document, -1));
  page += page_template.substr(data + kEmpty.size());
  return page;
}

ReportFiles FilesOf(const fs::path& page) {
  fs::path numbers = page;
  numbers.replace_extension();
  numbers += "_numbers.json";
  return {page, numbers};
}

ReportFiles DefaultReportFiles(const std::vector<fs::path>& runs) {
  if (runs.size() == 1) return FilesOf(runs.front() / "report.html");
  std::string name;
  for (const fs::path& run : runs) name += (name.empty() ? "" : "_vs_") + RunName(run);
  if (name.size() > kLongestName)
    throw InputError("the names of the runs are too long for a file name; give --output FILE");
  const fs::path beside = (runs.front() / "..").lexically_normal();
  return FilesOf(beside / (name + ".html"));
}

json WriteReport(const std::vector<fs::path>& runs, const ReportFiles& files) {
  json document = ReportDocument(runs);
  WriteFileAtomically(files.numbers, Dump(WithoutPackedArrays(document), 1) + "\n");
  WriteFileAtomically(files.page, ReportPage(ReportTemplate(), document));
  return document;
}

}  // namespace lacuna
