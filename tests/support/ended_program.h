// A program as a user starts it: what it prints, and how it ends.
#ifndef LACUNA_TESTS_SUPPORT_ENDED_PROGRAM_H_
#define LACUNA_TESTS_SUPPORT_ENDED_PROGRAM_H_

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace lacuna {

struct Ending {
  int status = -1;   // the exit status; -1 where a signal ended the program
  std::string said;  // standard output and error
};

// Runs a command line of the shell.
inline Ending EndingOf(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  Ending ending;
  std::array<char, 4096> buffer;
  while (const size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
    ending.said.append(buffer.data(), count);
  const int status = pclose(pipe);
  ending.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ending;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_ENDED_PROGRAM_H_
