#include "sweep/sweep_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace lacuna {
namespace {

constexpr size_t kMostCases = 100'000;

using Changes = std::vector<RequestedChange>;

void RefuseOwnFields(const Config& config, const std::string& field) {
  if (field == "output") config.Fail(field, "cannot be set: every case has its own output folder");
  if (field == "use") config.Fail(field, "cannot be set; set the entries of that file instead");
}

// All combinations, the first field varying slowest.
std::vector<Changes> Grid(const Config& vary) {
  std::vector<Changes> grid = {{}};
  for (const std::string& field : vary.Keys()) {
    RefuseOwnFields(vary, field);
    const std::vector<std::string> values = vary.Texts(field);
    if (values.empty()) vary.Fail(field, "has no values; expected a list");
    if (grid.size() > kMostCases / values.size())
      vary.Fail(field, fmt::format("would give more than {} cases", kMostCases));
    std::vector<Changes> finer;
    for (const Changes& coarse : grid) {
      for (size_t k = 0; k < values.size(); ++k) {
        finer.push_back(coarse);
        finer.back().push_back({{field, values[k]}, [vary, field, k](const std::string& message) {
                                  vary.FailAtItem(field, k, message);
                                }});
      }
    }
    grid = std::move(finer);
  }
  return grid;
}

Changes ListedCase(const Config& item) {
  Changes changes;
  for (const std::string& field : item.Keys()) {
    RefuseOwnFields(item, field);
    changes.push_back({{field, item.Text(field)},
                       [item, field](const std::string& message) { item.Fail(field, message); }});
  }
  return changes;
}

std::string KeyOf(const Changes& changes) {
  std::string key;
  for (const RequestedChange& entry : changes)
    key += entry.change.field + "\n" + entry.change.value + "\n";
  return key;
}

std::vector<Changes> ReadChanges(const Config& config) {
  const auto vary = config.OptionalChild("vary");
  const std::vector<Config> items = config.Items("cases");
  std::vector<Changes> all;
  if (vary || items.empty()) all = vary ? Grid(*vary) : std::vector<Changes>{{}};
  for (const Config& item : items) all.push_back(ListedCase(item));
  std::set<std::string> known;
  for (size_t k = 0; k < all.size(); ++k) {
    std::sort(all[k].begin(), all[k].end(),
              [](const auto& a, const auto& b) { return a.change.field < b.change.field; });
    if (known.insert(KeyOf(all[k])).second) continue;
    const size_t listed = all.size() - items.size();
    if (k < listed) vary->Fail("", "has the same value twice");
    config.FailAtItem("cases", k - listed, "repeats another case");
  }
  return all;
}

}  // namespace

SweepFile ReadSweepFile(const Config& config) {
  SweepFile file;
  config.Integer("schema_version", 1, 1);
  file.identity.name = config.Text("name");
  file.identity.command = config.Choice<SweepCommand>("command", SweepCommands());
  const bool is_table = file.identity.command == SweepCommand::kTable1;
  if (is_table) {
    file.settings.seeds = config.Integer("seeds", 1, 1000, file.settings.seeds);
    file.settings.turns = config.Integer("turns", 0, 1000, file.settings.turns);
  }
  const std::vector<std::string> experiments = config.Texts("experiments");
  if (experiments.empty())
    config.Fail("experiments", is_table ? "is missing; expected a folder of experiment files"
                                        : "is missing; expected an experiment file, or several");
  const std::vector<Changes> changes = ReadChanges(config);
  config.RefuseUnknownKeys();
  std::set<std::string> known;
  for (size_t k = 0; k < experiments.size(); ++k) {
    const std::filesystem::path path =
        (config.File().parent_path() / experiments[k]).lexically_normal();
    if (!known.insert(experiments[k]).second)
      config.FailAtItem("experiments", k, "is listed twice");
    if (is_table ? !std::filesystem::is_directory(path) : !std::filesystem::is_regular_file(path))
      config.FailAtItem(
          "experiments", k,
          fmt::format("there is no {} {}", is_table ? "folder" : "file", path.string()));
    for (const Changes& entry : changes) file.cases.push_back({experiments[k], path, entry});
  }
  return file;
}

}  // namespace lacuna
