// What the programs lacuna and lacuna-trials have in common: options that do not belong to a
// command, and the exit status of each kind of failure.
#ifndef LACUNA_APP_PROGRAM_H_
#define LACUNA_APP_PROGRAM_H_

#include <functional>
#include <optional>
#include <string_view>

namespace CLI {
class App;
}

namespace lacuna {

// The exit status for input that cannot be used. A command returns 0 when it is done, and 1 if its
// result is not usable.
inline constexpr int kUnusableInput = 2;

// Adds --memory-limit, which sets the limit of core/memory_limit.h when the command line is parsed.
void AddMemoryLimitOption(CLI::App* app);

// Parses the command line. Returns the exit status where the program ends with it: 0 after --help
// and the like, kUnusableInput after an error, which is printed on standard error.
std::optional<int> ParseCommandLine(CLI::App* app, int argc, char** argv);

// Calls `command` and returns its exit status. An exception is printed on standard error as
// "<program>: <message>"; the status is then 128 + signal for Interrupted and kUnusableInput for
// all others.
int ExitStatusOf(std::string_view program, const std::function<int()>& command);

}  // namespace lacuna

#endif  // LACUNA_APP_PROGRAM_H_
