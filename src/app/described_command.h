// The command line of a program as plain data, from which manual pages and completions are made.
#ifndef LACUNA_APP_DESCRIBED_COMMAND_H_
#define LACUNA_APP_DESCRIBED_COMMAND_H_

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lacuna {

struct DescribedOption {
  std::vector<std::string> names;    // "-o", "--output"; empty for a positional argument
  std::string value;                 // "TEXT", or the argument's name; empty for a flag
  std::vector<std::string> choices;  // the only values that are accepted; empty: any
  std::string description;
  bool required = false;
  bool repeated = false;  // takes several values
};

struct DescribedCommand {
  std::string name;         // "lacuna", "fit"
  std::string description;  // one sentence
  std::string footer;       // lines of text
  std::vector<DescribedOption> options, arguments;
  std::vector<DescribedCommand> commands;
  bool needs_command = false;
};

// Hidden options and commands, whose group is empty, are left out.
DescribedCommand Describe(const CLI::App& app);

// The usage in one line after the name of the program, e.g. "fit [OPTIONS] experiment".
std::string Synopsis(const DescribedCommand& command);

}  // namespace lacuna

#endif  // LACUNA_APP_DESCRIBED_COMMAND_H_
