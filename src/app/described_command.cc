#include "app/described_command.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <sstream>

namespace lacuna {
namespace {

// The values of CLI::IsMember, which the name of the type shows as "TEXT:{local,slurm}".
std::vector<std::string> ChoicesOf(const std::string& type) {
  std::vector<std::string> choices;
  const size_t open = type.find('{');
  if (open == std::string::npos || type.back() != '}') return choices;
  std::istringstream list(type.substr(open + 1, type.size() - open - 2));
  for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
  return choices;
}

DescribedOption DescribeOption(const CLI::Option& option) {
  DescribedOption described;
  for (const std::string& name : option.get_snames()) described.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) described.names.push_back("--" + name);
  const std::string type = option.get_type_name();
  if (option.get_positional()) {
    described.value = option.get_name(true, false);
  } else if (option.get_items_expected_max() > 0) {
    described.value = type.substr(0, type.find(':'));
  }
  described.choices = ChoicesOf(type);
  described.description = option.get_description();
  described.required = option.get_required();
  described.repeated = option.get_items_expected_max() > 1;
  return described;
}

}  // namespace

DescribedCommand Describe(const CLI::App& app) {
  DescribedCommand described;
  described.name = std::filesystem::path(app.get_name()).filename();
  described.description = app.get_description();
  described.footer = app.get_footer();
  described.needs_command = app.get_require_subcommand_min() > 0;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    auto& list = option->get_positional() ? described.arguments : described.options;
    list.push_back(DescribeOption(*option));
  }
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_group().empty()) described.commands.push_back(Describe(*command));
  return described;
}

std::string Synopsis(const DescribedCommand& command) {
  std::string text = command.name;
  if (!command.options.empty()) text += " [OPTIONS]";
  for (const DescribedOption& argument : command.arguments) {
    const std::string name = argument.value + (argument.repeated ? "..." : "");
    text += argument.required ? " " + name : " [" + name + "]";
  }
  if (!command.commands.empty()) text += command.needs_command ? " COMMAND" : " [COMMAND]";
  return text;
}

}  // namespace lacuna
