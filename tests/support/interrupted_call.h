// What becomes of a program that is running when this one is told to stop.
#ifndef LACUNA_TESTS_SUPPORT_INTERRUPTED_CALL_H_
#define LACUNA_TESTS_SUPPORT_INTERRUPTED_CALL_H_

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "core/interrupt.h"

namespace lacuna {

// Writes an executable shell script that writes its process number to `number`, whole from the
// first moment on, and continues with `then`. It finds no programs in PATH.
inline void WriteNumberedScript(const std::filesystem::path& script,
                                const std::filesystem::path& number, const std::string& then) {
  std::ofstream(script) << "#!/bin/sh\necho $$ > '" << number.string() << ".part'\n/bin/mv '"
                        << number.string() << ".part' '" << number.string() << "'\n"
                        << then << "\n";
  chmod(script.c_str(), 0755);
}

// For the body of a death test: makes a call that runs such a script, and sends SIGTERM to this
// process as soon as the script has written its number. Ends the process with the status 0 if the
// call throws Interrupted and the script has ended then.
[[noreturn]] inline void ExitAfterInterruptedCall(const std::filesystem::path& number,
                                                  const std::function<void()>& call) {
  signal(SIGTERM, SIG_DFL);
  InstallInterruptHandler();
  std::thread([number] {
    while (!std::filesystem::exists(number))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(getpid(), SIGTERM);
  }).detach();
  try {
    call();
  } catch (const Interrupted&) {
    pid_t script = 0;
    std::ifstream(number) >> script;
    const bool has_ended = script > 0 && kill(script, 0) != 0 && errno == ESRCH;
    std::_Exit(has_ended ? 0 : 1);
  }
  std::_Exit(2);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_INTERRUPTED_CALL_H_
