#include "sweep/sweep_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "record/json_hash.h"

namespace lacuna {
namespace {

constexpr int kSchemaVersion = 1;

// Reads a JSON file of a sweep. All errors name the file.
template <typename Read>
auto ReadVersioned(const std::filesystem::path& file, const Read& read) {
  return ReadJsonFile<nlohmann::ordered_json>(file, [&](const nlohmann::ordered_json& json) {
    if (json.at("schema_version") != kSchemaVersion)
      throw InputError({file.string()}, "was written by another version of Lacuna");
    return read(json);
  });
}

constexpr char kHash[] = "hash";

// The hash of an outcome's content. Two runs write the same one, because the wall time is left out.
std::string HashOf(const nlohmann::ordered_json& outcome) {
  return HashWithout(outcome, {"/hash", "/seconds"});
}

void Write(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  WriteFileAtomically(file, json.dump(2) + "\n");
}

}  // namespace

std::string Describe(const SweepCase& entry) {
  std::string text = entry.experiment;
  for (size_t k = 0; k < entry.changes.size(); ++k)
    text += fmt::format("{} {} = {}", k == 0 ? " with" : ",", entry.changes[k].field,
                        entry.changes[k].value);
  for (char& letter : text)
    if (letter == '\n' || letter == '\r') letter = ' ';
  return text;
}

void WriteIdentity(const SweepIdentity& identity, const std::filesystem::path& folder) {
  Write(folder / "sweep.json", {{"schema_version", kSchemaVersion},
                                {"name", identity.name},
                                {"command", NameOf(identity.command)}});
}

SweepIdentity ReadIdentity(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "sweep.json";
  if (!std::filesystem::exists(file))
    throw InputError({folder.string()},
                     "is not a sweep (it has no sweep.json); `lacuna sweep plan` "
                     "creates one");
  return ReadVersioned(file, [&](const auto& json) {
    const std::string command = json.at("command");
    for (const auto& [name, value] : SweepCommands())
      if (name == command) return SweepIdentity{json.at("name"), value};
    throw InputError({file.string()}, "has an unknown command: " + command);
  });
}

void WriteCase(const SweepCase& entry, const std::filesystem::path& case_folder) {
  nlohmann::ordered_json changes = nlohmann::ordered_json::object();
  for (const CaseChange& change : entry.changes) changes[change.field] = change.value;
  Write(case_folder / "case.json", {{"schema_version", kSchemaVersion},
                                    {"number", entry.number},
                                    {"experiment", entry.experiment},
                                    {"changes", changes},
                                    {"seeds", entry.settings.seeds},
                                    {"turns", entry.settings.turns}});
}

std::vector<SweepCase> ReadCases(const std::filesystem::path& folder) {
  std::vector<SweepCase> cases;
  for (const auto& item : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path file = item.path() / "case.json";
    if (item.path().filename().string().starts_with(".") || !std::filesystem::exists(file))
      continue;
    cases.push_back(ReadVersioned(file, [&](const auto& json) {
      SweepCase entry{json.at("number"), item.path().filename(), json.at("experiment"), {}, {}};
      for (const auto& [field, value] : json.at("changes").items())
        entry.changes.push_back({field, value});
      entry.settings.seeds = json.at("seeds");
      entry.settings.turns = json.at("turns");
      return entry;
    }));
  }
  std::sort(cases.begin(), cases.end(),
            [](const SweepCase& a, const SweepCase& b) { return a.number < b.number; });
  return cases;
}

void WriteOutcome(const CaseOutcome& outcome, const std::filesystem::path& case_folder) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::object(), words = numbers;
  for (const auto& [name, value] : outcome.numbers)
    numbers[name] = NumberOrNull<nlohmann::ordered_json>(value);
  for (const auto& [name, text] : outcome.words) words[name] = text;
  nlohmann::ordered_json json = {{"schema_version", kSchemaVersion},
                                 {"done", outcome.done},
                                 {"message", outcome.message},
                                 {"numbers", numbers},
                                 {"words", words},
                                 {"seconds", outcome.seconds}};
  json[kHash] = HashOf(json);
  Write(case_folder / "outcome.json", json);
}

std::optional<CaseOutcome> ReadOutcome(const std::filesystem::path& case_folder) {
  const std::filesystem::path file = case_folder / "outcome.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  return ReadVersioned(file, [&](const auto& json) {
    // Outcomes of earlier versions have no hash.
    if (json.contains(kHash) && json.at(kHash) != HashOf(json))
      throw InputError({file.string()}, "is damaged; remove it, and the case is run again");
    CaseOutcome outcome;
    outcome.done = json.at("done");
    outcome.message = json.at("message");
    for (const auto& [name, value] : json.at("numbers").items())
      outcome.numbers.emplace_back(name, NumberOr(value));
    for (const auto& [name, text] : json.at("words").items())
      outcome.words.emplace_back(name, text);
    outcome.seconds = json.at("seconds");
    return outcome;
  });
}

}  // namespace lacuna
