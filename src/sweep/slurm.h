// Submission of the cases of a sweep to Slurm as a job array.
#ifndef LACUNA_SWEEP_SLURM_H_
#define LACUNA_SWEEP_SLURM_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct SlurmOptions {
  std::filesystem::path program;     // the path of lacuna on the compute nodes
  std::vector<int> numbers;          // numbers of the cases to run, ascending; one task each
  int at_a_time = 0;                 // tasks that may run at once; 0 for Slurm's own limit
  bool retry_failed = false;         // passed on to the tasks
  uint64_t memory_limit = 0;         // bytes, passed on to the tasks; 0 for the nodes' own limits
  bool wait = false;                 // return only after all tasks have ended
  std::vector<std::string> options;  // further options of sbatch: "--partition=short"
};

// The case numbers in the format of `sbatch --array`: "1-3,7".
std::string ArrayOf(const std::vector<int>& numbers);

// The job script: task K runs `lacuna sweep run FOLDER --case K` with the cores allotted to it.
std::string SlurmScript(const std::filesystem::path& folder, const SlurmOptions& options);

// Writes <folder>/slurm/job.sh and submits it; the output of the tasks goes to <folder>/slurm, too,
// and the id of the job to job_id.txt there. Returns the id. Throws InputError if there is no
// sbatch in PATH or if it refuses, and Interrupted after it has ended sbatch. Tasks that are
// submitted already go on.
std::string SubmitToSlurm(const std::filesystem::path& folder, const SlurmOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SLURM_H_
