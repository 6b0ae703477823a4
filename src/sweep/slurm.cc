#include "sweep/slurm.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/spawn_attributes.h"

extern char** environ;

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// The program of this name in PATH.
fs::path FindProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / name;
    if (access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file)) return file;
  }
  throw InputError(
      fmt::format("there is no {} in PATH: --launcher slurm needs Slurm's commands "
                  "(Debian: slurm-client); --launcher local does without",
                  name));
}

// `text` in single quotes for a shell.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// Runs a program and returns its standard output. Its standard error goes to that of this process.
std::string OutputOf(std::vector<std::string> arguments, int* status) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw InputError(fmt::format("pipe: {}", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  const SpawnAttributes attributes;
  pid_t child = 0;
  const int error =
      posix_spawn(&child, pointers[0], &actions, attributes.Get(), pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string output;
  if (error == 0) {
    std::array<char, 4096> buffer{};
    for (ssize_t count = 0; (count = read(ends[0], buffer.data(), buffer.size())) > 0;)
      output.append(buffer.data(), static_cast<size_t>(count));
    waitpid(child, status, 0);
  }
  close(ends[0]);
  if (error != 0)
    throw InputError(fmt::format("{} cannot be run: {}", arguments[0], std::strerror(error)));
  return output;
}

}  // namespace

std::string ArrayOf(const std::vector<int>& numbers) {
  std::string text;
  for (size_t first = 0; first < numbers.size();) {
    size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (!text.empty()) text += ",";
    text += std::to_string(numbers[first]);
    if (last > first) text += "-" + std::to_string(numbers[last]);
    first = last + 1;
  }
  return text;
}

std::string SlurmScript(const fs::path& folder, const SlurmOptions& options) {
  const std::string most =
      options.at_a_time > 0 ? fmt::format("%{}", options.at_a_time) : std::string();
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --array={}{}\n"
      "#SBATCH --output=slurm/%A_%a.txt\n"
      "exec {} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\" sweep run {} --case "
      "\"$SLURM_ARRAY_TASK_ID\"{}\n",
      ArrayOf(options.numbers), most, Quoted(options.program.string()), Quoted(folder.string()),
      options.retry_failed ? " --retry-failed" : "");
}

std::string SubmitToSlurm(const fs::path& given_folder, const SlurmOptions& options) {
  const fs::path sbatch = FindProgram("sbatch");
  const fs::path folder = fs::canonical(given_folder);
  MakeFolder(folder / "slurm");
  const fs::path script = folder / "slurm" / "job.sh";
  WriteFileAtomically(script, SlurmScript(folder, options));
  std::vector<std::string> arguments = {sbatch.string(), "--parsable", "--job-name=lacuna-sweep",
                                        "--chdir=" + folder.string()};
  if (options.wait) arguments.emplace_back("--wait");
  arguments.insert(arguments.end(), options.options.begin(), options.options.end());
  arguments.push_back(script.string());
  int status = 0;
  std::string job = OutputOf(arguments, &status);
  job = job.substr(0, job.find_first_of(";\n"));  // "id;cluster"
  // With --wait, sbatch returns the exit status of the tasks. A failed case is not an error here:
  // its outcome says so.
  const bool refused = !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && !options.wait);
  if (refused || job.empty())
    throw InputError(fmt::format("sbatch refused {}; its message is above", script.string()));
  return job;
}

}  // namespace lacuna
