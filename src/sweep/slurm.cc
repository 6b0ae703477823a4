#include "sweep/slurm.h"

#include <fmt/format.h>

#include <optional>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/run_program.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// `text` in single quotes for a shell.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
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
  const std::string limit = options.memory_limit > 0
                                ? fmt::format(" --memory-limit {}", options.memory_limit)
                                : std::string();
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --array={}{}\n"
      "#SBATCH --output=slurm/%A_%a.txt\n"
      "exec {} --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"{} sweep run {} --case "
      "\"$SLURM_ARRAY_TASK_ID\"{}\n",
      ArrayOf(options.numbers), most, Quoted(options.program.string()), limit,
      Quoted(folder.string()), options.retry_failed ? " --retry-failed" : "");
}

std::string SubmitToSlurm(const fs::path& given_folder, const SlurmOptions& options) {
  const std::optional<fs::path> sbatch = FindProgram("sbatch");
  if (!sbatch)
    throw InputError(
        "there is no sbatch in PATH: --launcher slurm needs Slurm's commands (Debian: "
        "slurm-client); --launcher local does without");
  const fs::path folder = fs::canonical(given_folder);
  MakeFolder(folder / "slurm");
  const fs::path script = folder / "slurm" / "job.sh";
  WriteFileAtomically(script, SlurmScript(folder, options));
  ProgramCall call{.program = *sbatch, .output = folder / "slurm" / "job_id.txt"};
  call.arguments = {"--parsable", "--job-name=lacuna-sweep", "--chdir=" + folder.string()};
  if (options.wait) call.arguments.emplace_back("--wait");
  call.arguments.insert(call.arguments.end(), options.options.begin(), options.options.end());
  call.arguments.push_back(script.string());
  // Its messages go to our standard error.
  const int status = RunProgram(call);
  std::string job = ReadWholeFile(call.output);
  job = job.substr(0, job.find_first_of(";\n"));  // "id;cluster"
  // With --wait, sbatch returns the exit status of the tasks. A failed case is not an error here:
  // its outcome says so.
  const bool refused = status < 0 || (status != 0 && !options.wait);
  if (refused || job.empty())
    throw InputError(fmt::format("sbatch refused {}; its message is above", script.string()));
  return job;
}

}  // namespace lacuna
