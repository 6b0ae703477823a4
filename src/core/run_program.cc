#include "core/run_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/spawn_attributes.h"

extern char** environ;

namespace lacuna {
namespace {

constexpr auto kPause = std::chrono::milliseconds(10);
// How long the program may take to end after SIGTERM. This one is itself ended after kStopGrace.
constexpr auto kProgramGrace = kStopGrace / 2;

// What the program does before it starts: it enters its folder and opens its output.
class FileActions {
 public:
  explicit FileActions(const ProgramCall& call) {
    posix_spawn_file_actions_init(&actions_);
    if (!call.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions_, call.folder.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, call.output.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (call.with_errors) posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  const posix_spawn_file_actions_t* Get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// Pointers to the texts, and null at the end.
std::vector<char*> PointersTo(std::vector<std::string>* texts) {
  std::vector<char*> pointers;
  for (std::string& text : *texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> EnvironmentOf(const ProgramCall& call) {
  std::vector<std::string> environment = call.environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string own = *entry;
    const std::string name = own.substr(0, own.find('=') + 1);
    bool is_replaced = false;
    for (const std::string& given : call.environment) is_replaced |= given.starts_with(name);
    if (!is_replaced) environment.push_back(own);
  }
  return environment;
}

constexpr int kUnknownStatus = -1;  // no status of waitpid with which a program has exited

// Whether the child ends within this time; `status` is then that of waitpid, or kUnknownStatus
// where the system keeps none, since SIGCHLD is ignored.
bool EndsWithin(pid_t child, std::chrono::milliseconds time, int* status) {
  for (const auto end = std::chrono::steady_clock::now() + time;;) {
    const pid_t ended = waitpid(child, status, WNOHANG);
    if (ended == child) return true;
    if (ended < 0 && errno != EINTR) {
      *status = kUnknownStatus;
      return true;
    }
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kPause);
  }
}

void Stop(pid_t child) {
  int status = 0;
  kill(child, SIGTERM);
  if (EndsWithin(child, kProgramGrace, &status)) return;
  kill(child, SIGKILL);
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
}

}  // namespace

std::optional<std::filesystem::path> FindProgram(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::filesystem::path program = std::filesystem::path(folder) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0)
      return program;
  }
  return std::nullopt;
}

int RunProgram(const ProgramCall& call) {
  ThrowIfInterrupted();
  std::vector<std::string> arguments = call.arguments;
  arguments.insert(arguments.begin(), call.program.string());
  std::vector<std::string> environment = EnvironmentOf(call);
  const FileActions actions(call);
  const SpawnAttributes attributes;
  pid_t child = 0;
  const int error = posix_spawn(&child, call.program.c_str(), actions.Get(), attributes.Get(),
                                PointersTo(&arguments).data(), PointersTo(&environment).data());
  if (error != 0)
    throw InputError(fmt::format("{} cannot be run{} with the output {}: {}", call.program.string(),
                                 call.folder.empty() ? "" : " in " + call.folder.string(),
                                 call.output.string(), std::strerror(error)));
  int status = 0;
  while (!EndsWithin(child, kPause, &status)) {
    if (!InterruptRequested()) continue;
    Stop(child);
    ThrowIfInterrupted();
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace lacuna
