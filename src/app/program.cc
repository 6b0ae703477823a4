#include "app/program.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <exception>
#include <new>

#include "core/interrupt.h"
#include "core/memory_limit.h"
#include "core/progress.h"

namespace lacuna {
namespace {

// Where nothing can be printed any more, on a full disk for instance, the exit status still says
// that the command has failed; fmt::print would throw.
void PrintProblem(std::string_view program, std::string_view message) {
  WriteLineToStandardError(fmt::format("{}: {}", program, message));
}

}  // namespace

void AddMemoryLimitOption(CLI::App* app) {
  app->add_option_function<uint64_t>(
         "--memory-limit", [](uint64_t bytes) { SetMemoryLimit(bytes); },
         "Refuse to start a computation that needs more memory than this, for example 4GB; the "
         "limit applies to each process; default: the machine's memory, or the limit of its "
         "container or control group if that is lower")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->check(CLI::Range(uint64_t{1'000'000}, uint64_t{1'000'000'000'000'000}));
}

std::optional<int> ParseCommandLine(CLI::App* app, int argc, char** argv) {
  try {
    app->parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app->exit(problem) == 0 ? 0 : kUnusableInput;
  }
  return std::nullopt;
}

int ExitStatusOf(std::string_view program, const std::function<int()>& command) {
  try {
    return command();
  } catch (const Interrupted& interrupted) {
    PrintProblem(program, kStoppedMessage);
    return interrupted.ExitCode();
  } catch (const std::bad_alloc&) {
    PrintProblem(program, "there is not enough memory");
  } catch (const std::exception& problem) {
    PrintProblem(program, problem.what());
  }
  return kUnusableInput;
}

}  // namespace lacuna
