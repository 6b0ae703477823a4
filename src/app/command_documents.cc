#include "app/command_documents.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>

#include "app/completions.h"
#include "app/described_command.h"
#include "app/man_page.h"
#include "record/library_versions.h"

namespace lacuna {
namespace {

std::string Document(const std::string& kind, const DescribedCommand& program) {
  if (kind == "bash") return BashCompletion(program);
  if (kind == "zsh") return ZshCompletion(program);
  return ManPage(program, "Lacuna " + ProgramVersion());
}

}  // namespace

void AddDocumentOption(CLI::App* app) {
  app->add_option_function<std::string>("--print-document",
                                        [app](const std::string& kind) {
                                          fmt::print("{}", Document(kind, Describe(*app)));
                                          throw CLI::Success();  // as --help ends the program
                                        })
      ->check(CLI::IsMember({"man", "bash", "zsh"}))
      ->group("");
}

}  // namespace lacuna
