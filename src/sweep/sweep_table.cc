#include "sweep/sweep_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/csv_text.h"
#include "core/json_number.h"
#include "core/text_layout.h"

namespace lacuna {
namespace {

constexpr size_t kNumbersInWords = 6;

using Cells = std::vector<std::vector<std::string>>;  // rows; the first one holds the column names

// The value of the entry of this name as text; empty if there is none.
template <typename Value>
std::string Find(const std::vector<std::pair<std::string, Value>>& entries,
                 const std::string& name) {
  for (const auto& [key, value] : entries)
    if (key == name) return fmt::format("{}", value);
  return "";
}

void Remember(const std::string& name, std::vector<std::string>* names) {
  if (std::find(names->begin(), names->end(), name) == names->end()) names->push_back(name);
}

// The columns of the table, in the order of their first appearance in the rows.
struct Columns {
  std::vector<std::string> fields, numbers, words;
  bool experiments = false;  // whether the rows have different experiments
};

Columns ColumnsOf(const std::vector<SweepRow>& rows) {
  Columns columns;
  for (const SweepRow& row : rows) {
    columns.experiments |= row.entry.experiment != rows.front().entry.experiment;
    for (const CaseChange& change : row.entry.changes) Remember(change.field, &columns.fields);
    if (!row.outcome) continue;
    for (const auto& [name, value] : row.outcome->numbers) Remember(name, &columns.numbers);
    for (const auto& [name, text] : row.outcome->words) Remember(name, &columns.words);
  }
  return columns;
}

std::string ValueOf(const SweepCase& entry, const std::string& field) {
  for (const CaseChange& change : entry.changes)
    if (change.field == field) return change.value;
  return "";
}

std::string CsvOf(const Cells& cells) {
  std::string text;
  for (const auto& row : cells) {
    for (size_t k = 0; k < row.size(); ++k) text += (k > 0 ? "," : "") + CsvField(row[k]);
    text += "\n";
  }
  return text;
}

Cells CellsForCsv(const SweepTable& table) {
  const Columns columns = ColumnsOf(table.rows);
  Cells cells = {{"number", "case", "experiment"}};
  cells[0].insert(cells[0].end(), columns.fields.begin(), columns.fields.end());
  for (const char* name : {"status", "note", "seconds"}) cells[0].emplace_back(name);
  for (const auto* names : {&columns.numbers, &columns.words})
    cells[0].insert(cells[0].end(), names->begin(), names->end());
  for (const SweepRow& row : table.rows) {
    const CaseOutcome outcome = row.outcome.value_or(CaseOutcome());
    std::vector<std::string> line = {std::to_string(row.entry.number), row.entry.name,
                                     row.entry.experiment};
    for (const std::string& field : columns.fields) line.push_back(ValueOf(row.entry, field));
    line.insert(line.end(), {NameOf(row.status), row.note,
                             row.outcome ? fmt::format("{}", outcome.seconds) : ""});
    for (const std::string& name : columns.numbers) line.push_back(Find(outcome.numbers, name));
    for (const std::string& name : columns.words) line.push_back(Find(outcome.words, name));
    cells.push_back(line);
  }
  return cells;
}

Cells CellsForWords(const SweepTable& table) {
  Columns columns = ColumnsOf(table.rows);
  columns.numbers.resize(std::min(columns.numbers.size(), kNumbersInWords));
  Cells cells = {{"case"}};
  if (columns.experiments) cells[0].emplace_back("experiment");
  cells[0].insert(cells[0].end(), columns.fields.begin(), columns.fields.end());
  cells[0].emplace_back("status");
  cells[0].insert(cells[0].end(), columns.numbers.begin(), columns.numbers.end());
  for (const SweepRow& row : table.rows) {
    std::vector<std::string> line = {row.entry.name};
    if (columns.experiments) line.push_back(row.entry.experiment);
    for (const std::string& field : columns.fields) line.push_back(ValueOf(row.entry, field));
    line.push_back(NameOf(row.status));
    for (const std::string& name : columns.numbers) {
      std::string number;
      if (row.outcome)
        for (const auto& [key, value] : row.outcome->numbers)
          if (key == name) number = std::isnan(value) ? "-" : fmt::format("{:.6g}", value);
      line.push_back(number);
    }
    cells.push_back(line);
  }
  return cells;
}

std::string Aligned(const Cells& cells) {
  std::vector<size_t> widths(cells.front().size());
  for (const auto& row : cells)
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], DisplayWidth(row[k]));
  std::string text;
  for (const auto& row : cells) {
    std::string line;
    for (size_t k = 0; k < row.size(); ++k) line += PaddedRight(row[k], widths[k] + 2);
    line.resize(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

nlohmann::ordered_json JsonOf(const SweepTable& table) {
  nlohmann::ordered_json json = {{"schema_version", 1},
                                 {"name", table.identity.name},
                                 {"command", NameOf(table.identity.command)}};
  for (const CaseStatus status :
       {CaseStatus::kPlanned, CaseStatus::kRunning, CaseStatus::kDone, CaseStatus::kFailed})
    json[NameOf(status)] = table.Count(status);
  json["cases"] = nlohmann::ordered_json::array();
  for (const SweepRow& row : table.rows) {
    nlohmann::ordered_json entry = {
        {"number", row.entry.number},         {"case", row.entry.name},
        {"experiment", row.entry.experiment}, {"changes", nlohmann::ordered_json::object()},
        {"status", NameOf(row.status)},       {"note", row.note}};
    for (const CaseChange& change : row.entry.changes)
      entry["changes"][change.field] = change.value;
    if (row.outcome) {
      entry["seconds"] = row.outcome->seconds;
      entry["numbers"] = nlohmann::ordered_json::object();
      entry["words"] = nlohmann::ordered_json::object();
      for (const auto& [name, value] : row.outcome->numbers)
        entry["numbers"][name] = NumberOrNull<nlohmann::ordered_json>(value);
      for (const auto& [name, text] : row.outcome->words) entry["words"][name] = text;
    }
    json["cases"].push_back(entry);
  }
  return json;
}

}  // namespace

std::string NameOf(CaseStatus status) {
  switch (status) {
    case CaseStatus::kPlanned:
      return "planned";
    case CaseStatus::kRunning:
      return "running";
    case CaseStatus::kDone:
      return "done";
    case CaseStatus::kFailed:
      break;
  }
  return "failed";
}

int SweepTable::Count(CaseStatus status) const {
  return static_cast<int>(std::count_if(
      rows.begin(), rows.end(), [status](const SweepRow& row) { return row.status == status; }));
}

SweepTable CollectSweep(const std::filesystem::path& folder) {
  SweepTable table{ReadIdentity(folder), {}};
  for (const SweepCase& entry : ReadCases(folder)) {
    SweepRow row{entry, CaseStatus::kPlanned, "", ReadOutcome(folder / entry.name)};
    if (row.outcome) {
      row.status = row.outcome->done ? CaseStatus::kDone : CaseStatus::kFailed;
      row.note = row.outcome->message;
    } else {
      row.note = HolderOf(folder / entry.name / "claimed");
      if (!row.note.empty()) row.status = CaseStatus::kRunning;
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string TableInWords(const SweepTable& table) {
  std::string text = Aligned(CellsForWords(table));
  text += fmt::format("\n{} cases of {}: {} done, {} failed, {} running, {} planned\n",
                      table.rows.size(), table.identity.name, table.Count(CaseStatus::kDone),
                      table.Count(CaseStatus::kFailed), table.Count(CaseStatus::kRunning),
                      table.Count(CaseStatus::kPlanned));
  for (const SweepRow& row : table.rows)
    if (row.status == CaseStatus::kRunning || row.status == CaseStatus::kFailed)
      text += fmt::format("{} {}: {}\n", row.entry.name, NameOf(row.status), row.note);
  if (table.Unfinished() > 0)
    text +=
        fmt::format("{} unfinished; `lacuna sweep run` continues with them\n", table.Unfinished());
  return text;
}

void WriteTable(const SweepTable& table, const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "table.txt", TableInWords(table));
  WriteFileAtomically(folder / "table.csv", CsvOf(CellsForCsv(table)));
  WriteFileAtomically(folder / "table.json", JsonOf(table).dump(2) + "\n");
}

std::string CasesAsCsv(const std::vector<SweepCase>& cases) {
  std::vector<SweepRow> rows;
  for (const SweepCase& entry : cases) rows.push_back({entry, CaseStatus::kPlanned, "", {}});
  const Columns columns = ColumnsOf(rows);
  Cells cells = {{"number", "case", "experiment"}};
  cells[0].insert(cells[0].end(), columns.fields.begin(), columns.fields.end());
  for (const SweepCase& entry : cases) {
    cells.push_back({std::to_string(entry.number), entry.name, entry.experiment});
    for (const std::string& field : columns.fields) cells.back().push_back(ValueOf(entry, field));
  }
  return CsvOf(cells);
}

}  // namespace lacuna
