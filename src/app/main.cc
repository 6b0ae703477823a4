// lacuna: the command line. Each command has a file of its own.
#include <fmt/format.h>
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "app/command_documents.h"
#include "app/commands.h"
#include "app/program.h"
#include "core/blas_kernels.h"
#include "core/interrupt.h"
#include "core/logging.h"
#include "core/parallel.h"
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

std::string UnknownCommand(const CLI::App& app, const std::string& given) {
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  return fmt::format("there is no command \"{}\"{}; lacuna --help lists them", given,
                     lacuna::Suggestion(given, known));
}

// Why a command cannot use an argument that nothing has taken. `arguments`: all that were given.
// (The value of an option of the program may have been taken for an argument of the command.)
std::string UnexpectedArgument(const CLI::App& app, const std::string& given,
                               const std::vector<std::string>& arguments) {
  const size_t equals = given.find('=');
  const CLI::Option* option = app.get_option_no_throw(given.substr(0, equals));
  if (option == nullptr)
    return fmt::format("unexpected argument \"{}\"; --help lists those that are known", given);
  const bool has_value = option->get_items_expected_min() > 0 && equals == std::string::npos;
  const auto at = std::find(arguments.begin(), arguments.end(), given);
  const bool is_last = std::distance(at, arguments.end()) < 2;
  const std::string value = !has_value ? "" : is_last ? " VALUE" : " " + *std::next(at);
  return fmt::format("\"{0}\" must come before the command: lacuna {0}{1} {2} ...", given, value,
                     app.get_subcommands().front()->get_name());
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
  lacuna::OutputOptions output;
  app.add_option("--threads", threads, "Number of threads; the results do not depend on it")
      ->check(CLI::Range(1, 1024));
  lacuna::AddMemoryLimitOption(&app);
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
  if (const std::optional<int> ended = lacuna::ParseCommandLine(&app, argc, argv)) return *ended;
  if (!app.remaining(true).empty()) {
    const std::string given = app.remaining(true).front();
    fmt::print(stderr, "lacuna: {}\n",
               command ? UnexpectedArgument(app, given, {argv + 1, argv + argc})
                       : UnknownCommand(app, given));
    return lacuna::kUnusableInput;
  }
  if (!command) {
    fmt::print("{}", app.help());
    return lacuna::kUnusableInput;
  }
  if (threads > 0) lacuna::SetThreadCount(threads);
  if (output.verbose) lacuna::SetLogLevel(lacuna::LogLevel::kInfo);
  return lacuna::ExitStatusOf("lacuna", command);
}
