#include "faults/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <thread>

#include "core/error.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr int kNoDisk = 125, kNoFolder = 126, kNoProgram = 127;  // exit statuses

bool WriteTo(const char* file, const std::string& text) {
  const int descriptor = open(file, O_WRONLY);
  if (descriptor < 0) return false;
  const bool is_written = write(descriptor, text.data(), text.size()) == ssize_t(text.size());
  close(descriptor);
  return is_written;
}

// Mounts a tmpfs over the folder, which this process and its children see and nobody else. They
// become the superuser of a user namespace, for which no rights are needed on most machines.
bool MountSmallDisk(const fs::path& place, uint64_t bytes) {
  const uid_t user = geteuid();
  const gid_t group = getegid();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  WriteTo("/proc/self/setgroups", "deny");
  if (!WriteTo("/proc/self/uid_map", fmt::format("0 {} 1", user)) ||
      !WriteTo("/proc/self/gid_map", fmt::format("0 {} 1", group)))
    return false;
  return mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", place.c_str(), "tmpfs", 0, fmt::format("size={}", bytes).c_str()) == 0;
}

[[noreturn]] void RunProgram(const fs::path& program, const std::vector<std::string>& arguments) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  _exit(kNoProgram);
}

// Runs the program in a child, and copies what is on the disk before the disk goes with this
// process.
[[noreturn]] void RunOnDisk(const SmallDisk& disk, const fs::path& program,
                            const std::vector<std::string>& arguments, const fs::path& where) {
  try {
    if (!MountSmallDisk(disk.place, disk.bytes)) _exit(kNoDisk);
    if (fs::exists(disk.content)) fs::copy(disk.content, disk.place, fs::copy_options::recursive);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const pid_t child = fork();
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (chdir(where.c_str()) != 0) _exit(kNoFolder);
      RunProgram(program, arguments);
    }
    int status = 0;
    waitpid(child, &status, 0);
    while (waitpid(-1, nullptr, 0) > 0) continue;  // what it has started writes to the disk, too
    fs::remove_all(disk.left);
    fs::copy(disk.place, disk.left, fs::copy_options::recursive);
    if (WIFSIGNALED(status)) raise(SIGKILL);
    _exit(WEXITSTATUS(status));
  } catch (const std::exception& problem) {
    dprintf(STDERR_FILENO, "%s\n", problem.what());
    _exit(kNoDisk);
  }
}

}  // namespace

Process::Process(const fs::path& program, const std::vector<std::string>& arguments,
                 const fs::path& where, const fs::path& log, const ProcessOptions& options) {
  // Processes whose parent was killed become children of this one, which can then wait for them.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  pid_ = fork();
  if (pid_ < 0) throw InputError("no process can be started");
  if (pid_ > 0) {
    group_ = pid_;
    setpgid(pid_, pid_);  // here and in the child, so that neither is too late
    return;
  }
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  if (options.disk) RunOnDisk(*options.disk, program, arguments, where);
  if (chdir(where.c_str()) != 0) _exit(kNoFolder);
  if (options.largest_file != ProcessOptions::kUnlimited) {
    const rlimit limit{options.largest_file, options.largest_file};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);  // the write fails, as on a full disk
  }
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  RunProgram(program, arguments);
}

int Process::Wait() {
  if (pid_ > 0) waitpid(pid_, &status_, 0);
  pid_ = 0;
  if (group_ > 0) {
    while (waitpid(-group_, nullptr, 0) > 0) continue;
  }
  group_ = 0;
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
}

bool Process::EndsWithin(Seconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (pid_ > 0 && std::chrono::steady_clock::now() < end) {
    if (waitpid(pid_, &status_, WNOHANG) == pid_)
      pid_ = 0;
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return pid_ == 0;
}

void Process::Kill() {
  if (group_ > 0) kill(-group_, SIGKILL);
  Wait();
}

std::string SmallDiskProblem(const fs::path& folder) {
  const pid_t child = fork();
  if (child < 0) return "no process can be started";
  if (child == 0) _exit(MountSmallDisk(folder, 1 << 16) ? 0 : std::max(1, errno));
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return fmt::format("no permission to mount ({})", std::strerror(WEXITSTATUS(status)));
}

}  // namespace lacuna
