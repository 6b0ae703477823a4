// lacuna: the command line, and the exit status of each kind of failure. Each command has a file of
// its own.
#include <fmt/format.h>
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "app/command_documents.h"
#include "app/commands.h"
#include "core/blas_kernels.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/logging.h"
#include "core/memory_limit.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/suggestion.h"
#include "record/library_versions.h"

namespace {

constexpr char kFooter[] = R"(Start here:
  lacuna validate experiments/bend.yaml        check a file without running it
  lacuna reconstruct experiments/bend.yaml     scans -> model with forces; results/bend
  lacuna fit experiments/hidden_effect.yaml    predict, and fit the model's parameters
  lacuna compare results/hidden_effect         where and when that model fails
  lacuna diagnose results/hidden_effect        which physical effect it lacks
  lacuna report results/hidden_effect          all of this as a page for the browser
  lacuna export results/hidden_effect --to inp  the fitted model for another FEM program
  lacuna sweep plan experiments/sweeps/bend_grid.yaml FOLDER   many experiments at once
  lacuna info experiments/recordings/bend      what a recording, mesh or run holds
  lacuna simulate experiments/scenes/twist.yaml --recording scan   make a recording of your own
  lacuna effects                               what physics a model can have
  lacuna explain gravity                       one of them in full

Exit status: 0 done; 1 a result is not usable (the record says why); 2 unusable input;
130 stopped by Ctrl-C (run the same command again to resume).)";

constexpr int kUnusableInput = 2;

std::string UnknownCommand(const CLI::App& app, const std::string& given) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  return fmt::format("there is no command \"{}\"{}; lacuna --help lists them", given,
                     lacuna::Suggestion(given, known));
}

// Prints a message. Where nothing can be printed any more, on a full disk for instance, the exit
// status still says that the command has failed; fmt::print would throw.
void Say(std::string_view message) {
  lacuna::WriteLineToStandardError(fmt::format("lacuna: {}", message));
}

}  // namespace

int main(int argc, char** argv) {
  lacuna::UseFastBlasKernels(argv);
  lacuna::InitialiseLogging(argv[0]);
  lacuna::InstallInterruptHandler();

  CLI::App app{
      "Turns recordings of a deforming soft object into a finite-element model that moves like "
      "it, and finds out which physical effect the model still lacks."};
  app.footer(kFooter);
  app.set_version_flag("--version", lacuna::ProgramVersion());
  app.allow_extras();  // reported below, with a suggestion
  int threads = 0;
  uint64_t memory_limit = 0;
  lacuna::OutputOptions output;
  app.add_option("--threads", threads, "Threads to use; results do not depend on it")
      ->check(CLI::Range(1, 1024));
  app.add_option("--memory-limit", memory_limit,
                 "Refuse to begin what needs more memory than this, for example 4GB; for each "
                 "process; default: the machine's memory")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->check(CLI::Range(uint64_t{1'000'000}, uint64_t{1'000'000'000'000'000}));
  app.add_flag("-v,--verbose", output.verbose, "Log the progress of the stages in detail");

  std::function<int()> command;
  lacuna::AddReconstruct(&app, &output, &command);
  lacuna::AddFit(&app, &output, &command);
  lacuna::AddCompare(&app, &output, &command);
  lacuna::AddDiagnose(&app, &output, &command);
  lacuna::AddPlan(&app, &output, &command);
  lacuna::AddAdd(&app, &output, &command);
  lacuna::AddReport(&app, &output, &command);
  lacuna::AddTable1(&app, &output, &command);
  lacuna::AddSweep(&app, &command);
  lacuna::AddAblation(&app, &command);
  lacuna::AddFigures(&app, &command);
  lacuna::AddSimulate(&app, &command);
  lacuna::AddInfo(&app, &command);
  lacuna::AddValidate(&app, &command);
  lacuna::AddEffects(&app, &command);
  lacuna::AddExplain(&app, &command);
  lacuna::AddExport(&app, &command);
  lacuna::AddImport(&app, &command);
  lacuna::AddDocumentOption(&app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : kUnusableInput;
  }
  if (!app.remaining(true).empty()) {
    const std::string unexpected = app.remaining(true).front();
    fmt::print(stderr, "lacuna: {}\n",
               command
                   ? fmt::format("unexpected argument \"{}\"; --help lists those that are known",
                                 unexpected)
                   : UnknownCommand(app, unexpected));
    return kUnusableInput;
  }
  if (!command) {
    fmt::print("{}", app.help());
    return kUnusableInput;
  }
  if (threads > 0) lacuna::SetThreadCount(threads);
  if (memory_limit > 0) lacuna::SetMemoryLimit(memory_limit);
  if (output.verbose) lacuna::SetLogLevel(lacuna::LogLevel::kInfo);

  try {
    return command();
  } catch (const lacuna::InputError& problem) {
    Say(problem.what());
    return kUnusableInput;
  } catch (const lacuna::Interrupted& interrupted) {
    Say(lacuna::kStoppedMessage);
    return interrupted.ExitCode();
  } catch (const std::bad_alloc&) {
    Say("there is not enough memory");
    return kUnusableInput;
  } catch (const std::exception& problem) {
    Say(problem.what());
    return kUnusableInput;
  }
}
