#include "sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "core/atomic_file.h"
#include "core/changed_yaml.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/text_file.h"
#include "sweep/sweep_file.h"
#include "sweep/sweep_table.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kLockName[] = ".planning";
constexpr char kExperiments[] = "experiments";  // of Table 1, in the folder of a case

// The keys of an experiment whose values are paths, relative to the file that contains them.
const std::set<std::string>& PathKeys() {
  static const std::set<std::string> keys = {"output",       "recording", "scene",
                                             "true_forces",  "true_mesh", "true_positions",
                                             "true_surfaces"};
  return keys;
}

// The hash of everything that identifies a case.
std::string HashOf(const SweepCase& entry, SweepCommand command) {
  std::string text = NameOf(command) + "\n" + entry.experiment + "\n";
  for (const CaseChange& change : entry.changes) text += change.field + "\n" + change.value + "\n";
  if (command == SweepCommand::kTable1)
    text += fmt::format("{} {}\n", entry.settings.seeds, entry.settings.turns);
  return HashBytes(text);
}

// The experiment's files: name in the folder of the case → path of the source.
std::map<std::string, fs::path> FilesOf(SweepCommand command, const fs::path& experiment) {
  if (command != SweepCommand::kTable1) return {{"experiment.yaml", experiment}};
  std::map<std::string, fs::path> files;
  for (const auto& entry : fs::directory_iterator(experiment))
    if (entry.path().extension() == ".yaml")
      files[kExperiments + ("/" + entry.path().filename().string())] = entry.path();
  if (files.empty()) throw InputError({experiment.string()}, "contains no .yaml file");
  return files;
}

CaseFiles Compose(SweepCommand command, const SweepCase& entry, const RequestedCase& request,
                  const fs::path& sweep_file, const fs::path& folder) {
  CaseFiles composed;
  for (const auto& [name, source] : FilesOf(command, request.path)) {
    const fs::path target = folder / name;
    std::vector<YamlChange> changes;
    for (const CaseChange& change : entry.changes)
      changes.push_back({change.field, change.value, sweep_file});
    if (command == SweepCommand::kReconstruct || command == SweepCommand::kFit)
      changes.push_back({"output", "run", target});
    composed[name] = "# " + Describe(entry) + "\n" +
                     ChangedYaml(source, changes, PathKeys(), target.parent_path());
  }
  return composed;
}

// The planned case in `folder` must have these files and, of a folder of experiments, no other.
void RequireSameFiles(SweepCommand command, const CaseFiles& files, const fs::path& folder) {
  const auto refuse = [](const char* how, const fs::path& planned) {
    throw InputError(fmt::format("{} {}, which was planned before; plan into another folder", how,
                                 planned.string()));
  };
  for (const auto& [name, text] : files)
    if (ReadWholeFile(folder / name) != text) refuse("differs from", folder / name);
  if (command != SweepCommand::kTable1) return;
  for (const auto& [name, planned] : FilesOf(command, folder / kExperiments))
    if (!files.contains(name)) refuse("no longer contains the file of", planned);
}

// The part of a message that concerns this field, or a mapping around it that had to be added:
// "mesh.max_volume: got …" → "got …". Empty if the message concerns something else.
std::string MessageAbout(const std::string& field, const std::string& message) {
  for (std::string named = field; !named.empty();) {
    for (size_t at = message.find(named); at != std::string::npos;
         at = message.find(named, at + 1)) {
      if (at > 0 && message[at - 1] != ' ') continue;
      const std::string rest = message.substr(at + named.size());
      if (rest.starts_with(": ")) return named == field ? rest.substr(2) : message.substr(at);
      if (named == field && (rest.starts_with(".") || rest.starts_with("[")))
        return message.substr(at);
    }
    const size_t cut = named.find_last_of(".[");
    named.resize(cut == std::string::npos ? 0 : cut);
  }
  return "";
}

// Throws an error about a case at the position of the change that it concerns, or else for the
// sweep file as a whole.
[[noreturn]] void Refuse(const RequestedCase& request, const SweepCase& entry,
                         const Config& sweep_file, const std::string& message) {
  for (auto change = request.changes.rbegin(); change != request.changes.rend(); ++change) {
    const std::string about = MessageAbout(change->change.field, message);
    if (!about.empty()) change->refuse(about);
  }
  throw InputError({sweep_file.File().string()}, Describe(entry) + ": " + message);
}

// A folder that does not exist yet is accepted.
void RefuseForeignFolder(const fs::path& folder, const SweepIdentity& identity) {
  // The folder is listed before sweep.json is looked for: another process that plans a sweep here
  // writes that file before the others, so that it is found wherever one of the others was listed.
  std::vector<fs::path> files;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().filename() != kLockName && !IsTemporaryFile(entry.path()))
        files.push_back(entry.path());
  if (fs::exists(folder / "sweep.json")) {
    const SweepIdentity known = ReadIdentity(folder);
    if (known.command != identity.command)
      throw InputError(
          {folder.string()},
          fmt::format("contains a sweep of `{}`; choose another folder", NameOf(known.command)));
    return;
  }
  if (!files.empty())
    throw InputError({folder.string()}, "is neither empty nor a sweep; choose another folder");
}

std::vector<SweepCase> PlannedCases(const fs::path& folder) {
  return fs::is_directory(folder) ? ReadCases(folder) : std::vector<SweepCase>();
}

// The cases that a sweep file adds to those of a folder, with their files.
struct Additions {
  std::vector<SweepCase> before;  // the cases that the folder has, by number
  std::vector<std::pair<SweepCase, CaseFiles>> added;
  std::vector<std::string> absent;  // see SweepPlan
};

// Reads and checks everything, and writes nothing.
Additions CheckedAdditions(const Config& sweep_file, const SweepFile& file,
                           const fs::path& folder) {
  const SweepCommand command = file.identity.command;
  RefuseForeignFolder(folder, file.identity);
  Additions additions;
  additions.before = PlannedCases(folder);
  std::map<std::string, SweepCase> known;  // by hash
  int number = 0;
  for (const SweepCase& entry : additions.before) {
    known[HashOf(entry, command)] = entry;
    number = std::max(number, entry.number);
  }
  std::set<std::string> wanted;
  for (const RequestedCase& request : file.cases) {
    SweepCase entry{0, "", request.experiment, {}, file.settings};
    for (const RequestedChange& change : request.changes) entry.changes.push_back(change.change);
    const std::string hash = HashOf(entry, command);
    const auto before = known.find(hash);
    wanted.insert(hash);
    entry.number = before == known.end() ? ++number : before->second.number;
    entry.name = fmt::format("{:04}-{}", entry.number, hash.substr(0, 8));
    try {
      const CaseFiles files =
          Compose(command, entry, request, sweep_file.File(), folder / entry.name);
      if (before == known.end()) {
        CheckCase(command, files, folder / entry.name);
        additions.added.emplace_back(entry, files);
        continue;
      }
      RequireSameFiles(command, files, folder / entry.name);
    } catch (const InputError& problem) {
      Refuse(request, entry, sweep_file, problem.what());
    }
  }
  for (const auto& [hash, entry] : known)
    if (!wanted.contains(hash)) additions.absent.push_back(entry.name);
  std::sort(additions.absent.begin(), additions.absent.end());
  return additions;
}

fs::path PartialFolder(const fs::path& folder, const SweepCase& entry) {
  return folder / ("." + entry.name + ".partial");
}

void WriteCaseFolder(const SweepCase& entry, const CaseFiles& files, const fs::path& folder) {
  const fs::path partial = PartialFolder(folder, entry);
  fs::remove_all(partial);
  MakeFolder(partial);
  for (const auto& [name, text] : files) {
    MakeFolder((partial / name).parent_path());
    WriteFileAtomically(partial / name, text);
  }
  WriteCase(entry, partial);
  fs::rename(partial, folder / entry.name);
}

}  // namespace

SweepPlan PlanSweep(const Config& sweep_file, const fs::path& given_folder) {
  const SweepFile file = ReadSweepFile(sweep_file);
  // Paths in the cases are relative and must not pass through a symbolic link.
  const fs::path folder = fs::weakly_canonical(fs::absolute(given_folder));
  Additions additions = CheckedAdditions(sweep_file, file, folder);
  MakeFolder(folder);
  const Claim claim(folder / kLockName);
  if (!claim.holds()) throw InputError({folder.string()}, "is being planned by another process");
  RemoveLeftTemporaries(folder);
  // Another process may have added cases before the folder was locked.
  if (PlannedCases(folder).size() != additions.before.size())
    additions = CheckedAdditions(sweep_file, file, folder);

  if (!fs::exists(folder / "sweep.json")) WriteIdentity(file.identity, folder);
  SweepPlan plan{std::move(additions.before), static_cast<int>(additions.added.size()),
                 std::move(additions.absent)};
  for (const auto& [entry, files] : additions.added) {
    WriteCaseFolder(entry, files, folder);
    plan.cases.push_back(entry);
  }
  SyncFolder(folder);
  WriteFileAtomically(folder / "cases.csv", CasesAsCsv(plan.cases));
  return plan;
}

}  // namespace lacuna
