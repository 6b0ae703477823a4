#include "report/study_document.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/json_file.h"
#include "record/csv_table.h"
#include "record/library_versions.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kNotableRatio = 1.2;  // of a found modulus to the true one

// The largest drop of each row, as far as the table has it, beside the paper's, and how far a found
// modulus is from the true one.
std::vector<std::string> Table1Headline(const json& table) {
  std::vector<std::string> sentences;
  for (const json& row : table.at("rows")) {
    const json& drop = row.at("drop_from_max").at("median");
    if (drop.is_null()) continue;
    const std::string name = row.at("name");
    std::string sentence =
        fmt::format("The search \"{}\" lowers the residual per point by {:.1f} %", name,
                    100 * drop.get<double>());
    if (row.contains("paper_drop"))
      sentence +=
          fmt::format("; that of the paper by {:.1f} %", 100 * row.at("paper_drop").get<double>());
    sentences.push_back(sentence + ".");
    const double found = row.at("young_modulus_Pa").at("median");
    const double truth = table.at("truth").at("young_modulus_Pa");
    if (std::abs(std::log(found / truth)) < std::log(kNotableRatio)) continue;
    sentences.push_back(fmt::format(
        "It ends at a Young's modulus of {:.3g} MPa where {:.3g} MPa is true: forces that are "
        "fitted make up for a wrong modulus.",
        1e-6 * found, 1e-6 * truth));
  }
  return sentences;
}

// How often verdicts were right, one sentence for each kind of truth.
std::vector<std::string> TrialsHeadline(const json& trials) {
  std::vector<std::string> sentences;
  if (trials.is_null()) return sentences;
  std::string truth;
  for (const json& rate : trials.value("rates", json::array())) {
    if (rate.at("of") == 0 || rate.at("truth") == truth) continue;
    truth = rate.at("truth");
    sentences.push_back(fmt::format("In {} of {} cases in which {}, {}.",
                                    rate.at("cases").get<int>(), rate.at("of").get<int>(), truth,
                                    rate.at("what").get<std::string>()));
  }
  return sentences;
}

// table1.json with the trace of each search.
json Table1WithTraces(const fs::path& folder) {
  json table = ReadJsonFile(folder / "table1.json");
  table["traces"] = json::object();
  for (const json& row : table.at("rows")) {
    const std::string name = row.at("name");
    if (const fs::path file = folder / (name + ".csv"); fs::exists(file))
      table["traces"][name] = TableToJson(ReadCsv(file));
  }
  return table;
}

// The report of sealed cases; null where there is none.
json FindTrials(const fs::path& folder) {
  const fs::path file = folder / "report.json";
  if (!fs::exists(file)) return nullptr;
  json report = ReadJsonFile(file);
  return report.is_object() && report.contains("tallies") ? report : json();
}

// How often intervals contain the truth; null where there is no such file, or that of one draw.
// Throws InputError for a damaged one.
json FindIntervals(const fs::path& folder) {
  const fs::path file = folder / "intervals.json";
  if (!fs::exists(file)) return nullptr;
  json report = ReadJsonFile(file);
  const json parameters = report.is_object() ? report.value("parameters", json()) : json();
  const bool is_of_draws = parameters.is_array() && !parameters.empty() &&
                           parameters.front().is_object() && parameters.front().contains("draws");
  return is_of_draws ? report : json();
}

// One sentence for each parameter.
std::vector<std::string> IntervalsHeadline(const json& intervals) {
  std::vector<std::string> sentences;
  if (intervals.is_null()) return sentences;
  for (const json& one : intervals.at("parameters"))
    sentences.push_back(
        fmt::format("The 95 % interval of {} contains the truth in {:.0f} % of {} "
                    "draws.",
                    one.at("name").get<std::string>(), 100 * one.at("covered_95").get<double>(),
                    one.at("draws").get<int>()));
  return sentences;
}

}  // namespace

bool IsStudy(const fs::path& folder) {
  return fs::exists(folder / "table1.json") || fs::exists(folder / "ablation.json") ||
         !FindTrials(folder).is_null() || !FindIntervals(folder).is_null();
}

GatheredRun GatherStudy(const fs::path& folder) {
  GatheredRun gathered;
  const bool has_table = fs::exists(folder / "table1.json");
  const bool has_ablation = fs::exists(folder / "ablation.json");
  json table;
  const auto add_sentences = [&](const char* what, const char* file, const auto& headline) {
    try {
      for (const std::string& sentence : headline()) gathered.sentences.push_back(sentence);
    } catch (const json::exception& problem) {
      throw InputError({(folder / file).string()},
                       fmt::format("is not {}: {}", what, problem.what()));
    }
  };
  if (has_table)
    add_sentences("a Table 1", "table1.json", [&] {
      table = Table1WithTraces(folder);
      return Table1Headline(table);
    });
  const json trials = FindTrials(folder), intervals = FindIntervals(folder);
  add_sentences("a report of sealed cases", "report.json", [&] { return TrialsHeadline(trials); });
  add_sentences("a table of intervals", "intervals.json",
                [&] { return IntervalsHeadline(intervals); });
  const std::string path = FromProject(folder, folder);
  json commands = json::array();
  if (has_table) {
    std::set<int> seeds;
    for (const json& search : table.at("searches")) seeds.insert(search.at("seed").get<int>());
    commands.push_back(fmt::format("lacuna table1 --output {} --seeds {}", path, seeds.size()));
  }
  commands.push_back("lacuna report " + path);
  json& document = gathered.document = EmptyRun(folder, has_table || has_ablation ? "table1"
                                                        : trials.is_null()        ? "intervals"
                                                                                  : "trials");
  gathered.comparable.name = document["name"];
  document["table1"] = table;
  if (has_ablation) document["ablation"] = ReadJsonFile(folder / "ablation.json");
  document["trials"] = trials;
  document["intervals"] = intervals;
  document["provenance"] = {{"program", "Lacuna " + ProgramVersion()}, {"commands", commands}};
  return gathered;
}

}  // namespace lacuna
