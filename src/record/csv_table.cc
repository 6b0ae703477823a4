#include "record/csv_table.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <fstream>
#include <set>
#include <string_view>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parsed_word.h"

namespace lacuna {
namespace {

std::vector<std::string_view> Split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (size_t begin = 0;;) {
    const size_t end = line.find(',', begin);
    fields.push_back(line.substr(begin, end - begin));
    if (end == std::string_view::npos) return fields;
    begin = end + 1;
  }
}

}  // namespace

void WriteCsv(const CsvTable& table, const std::filesystem::path& file) {
  CHECK(!table.empty()) << file << " would have no columns";
  std::set<std::string> names;
  std::string text;
  for (const CsvColumn& column : table) {
    CHECK(!column.name.empty() && column.name.find_first_of(",\"\r\n") == std::string::npos)
        << file << ": '" << column.name << "' cannot name a column";
    CHECK(names.insert(column.name).second) << file << ": two columns named " << column.name;
    CHECK_EQ(column.values.size(), table.front().values.size())
        << file << ": column " << column.name << " has another length than " << table.front().name;
    text += (text.empty() ? "" : ",") + column.name;
  }
  text += '\n';
  for (Eigen::Index row = 0; row < table.front().values.size(); ++row) {
    for (const CsvColumn& column : table) {
      fmt::format_to(std::back_inserter(text), "{}{}", &column == &table.front() ? "" : ",",
                     column.values[row]);
    }
    text += '\n';
  }
  WriteFileAtomically(file, text);
}

CsvTable ReadCsv(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError({file.string()}, "cannot be read: no such file, or no permission");
  std::string line;
  if (!std::getline(stream, line)) throw InputError({file.string()}, "is empty");
  CsvTable table;
  for (const std::string_view name : Split(line)) table.push_back({std::string(name), {}});
  std::vector<std::vector<double>> columns(table.size());
  for (int number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string_view> fields = Split(line);
    if (fields.size() != table.size()) {
      throw InputError({file.string(), number}, fmt::format("has {} fields; the header names {}",
                                                            fields.size(), table.size()));
    }
    for (size_t k = 0; k < fields.size(); ++k) {
      const auto value = ParseWord<double>(fields[k]);
      if (!value) {
        throw InputError({file.string(), number},
                         fmt::format("{}: got '{}'; expected a number", table[k].name, fields[k]));
      }
      columns[k].push_back(*value);
    }
  }
  for (size_t k = 0; k < table.size(); ++k) {
    table[k].values = Eigen::Map<const Eigen::VectorXd>(
        columns[k].data(), static_cast<Eigen::Index>(columns[k].size()));
  }
  return table;
}

const Eigen::VectorXd* FindColumn(const CsvTable& table, const std::string& name) {
  for (const CsvColumn& column : table)
    if (column.name == name) return &column.values;
  return nullptr;
}

const Eigen::VectorXd& ColumnOf(const CsvTable& table, const std::string& name,
                                const std::filesystem::path& file) {
  const Eigen::VectorXd* values = FindColumn(table, name);
  if (values == nullptr) throw InputError({file.string()}, "has no column " + name);
  return *values;
}

}  // namespace lacuna
