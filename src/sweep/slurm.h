// Hands the cases of a sweep to Slurm as a job array.
#ifndef LACUNA_SWEEP_SLURM_H_
#define LACUNA_SWEEP_SLURM_H_

#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct SlurmOptions {
  std::filesystem::path program;     // lacuna, where the nodes find it
  std::vector<int> numbers;          // of the cases, ascending; one task each
  int at_a_time = 0;                 // tasks that may run at once; 0: as many as Slurm allows
  bool retry_failed = false;         // given to the tasks
  bool wait = false;                 // return when all tasks have ended
  std::vector<std::string> options;  // further ones of sbatch: "--partition=short"
};

// "1-3,7": what sbatch --array wants.
std::string ArrayOf(const std::vector<int>& numbers);

// The job script: task K runs `lacuna sweep run FOLDER --case K` with the cores it was given.
std::string SlurmScript(const std::filesystem::path& folder, const SlurmOptions& options);

// Writes <folder>/slurm/job.sh and submits it; what tasks say goes to <folder>/slurm, too. Returns
// the job's id. Throws InputError when there is no sbatch in PATH, or when it refuses.
std::string SubmitToSlurm(const std::filesystem::path& folder, const SlurmOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SLURM_H_
