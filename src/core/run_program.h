// Running another program to its end.
#ifndef LACUNA_CORE_RUN_PROGRAM_H_
#define LACUNA_CORE_RUN_PROGRAM_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

// The executable file of this name in the folders of PATH; nothing if there is none.
std::optional<std::filesystem::path> FindProgram(const std::string& name);

struct ProgramCall {
  std::filesystem::path program;
  std::vector<std::string> arguments = {};    // without the name of the program
  std::filesystem::path folder = {};          // where it runs; empty: the current folder
  std::filesystem::path output;               // absolute; replaced by its standard output
  bool with_errors = false;                   // standard error goes there too, not to our own
  std::vector<std::string> environment = {};  // "NAME=value", in place of our own values
};

// Runs the program and returns its exit status, or −1 if a signal ended it. −1 is returned also
// where SIGCHLD is ignored, because the status is then not known. After SIGINT or SIGTERM
// (core/interrupt.h), the program receives SIGTERM, and SIGKILL if it has not ended soon after;
// then Interrupted is thrown. Programs that the started program has started in turn do not receive
// these signals. Throws InputError, which names program, folder and output, if the program cannot
// be started.
int RunProgram(const ProgramCall& call);

}  // namespace lacuna

#endif  // LACUNA_CORE_RUN_PROGRAM_H_
