// A process of the program under test, with its output in a file.
#ifndef LACUNA_TESTS_FAULTS_PROCESS_H_
#define LACUNA_TESTS_FAULTS_PROCESS_H_

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

using Seconds = std::chrono::duration<double>;

// A file system of a few bytes, which the process finds in the place of a folder.
struct SmallDisk {
  uint64_t bytes = 0;
  std::filesystem::path place;    // the folder, which must exist
  std::filesystem::path content;  // copied to the disk first; may be absent
  std::filesystem::path left;     // where the content is copied when the process has ended
};

struct ProcessOptions {
  static constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();
  uint64_t largest_file = kUnlimited;                // bytes
  std::map<std::string, std::string> environment{};  // beside that of this process
  std::optional<SmallDisk> disk{};
};

class Process {
 public:
  // Starts the program in the folder `where`. Throws InputError if that is impossible.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& where, const std::filesystem::path& log,
          const ProcessOptions& options = {});
  ~Process() { Kill(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Waits until the process and all that it has started have ended. The exit status; −1: it was
  // killed by a signal.
  int Wait();
  // Whether it has ended within this time.
  bool EndsWithin(Seconds time);
  // Kills the process and all that it has started, and waits until they are gone.
  void Kill();

 private:
  pid_t pid_ = 0, group_ = 0;
  int status_ = 0;
};

// Why no small disk can be made here; empty: it can.
std::string SmallDiskProblem(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_PROCESS_H_
