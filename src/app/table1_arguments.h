// The command-line arguments that `lacuna table1` and `lacuna ablation` share.
#ifndef LACUNA_APP_TABLE1_ARGUMENTS_H_
#define LACUNA_APP_TABLE1_ARGUMENTS_H_

#include <string>

#include "paper/table1.h"

namespace CLI {
class App;
}

namespace lacuna {

struct Table1Arguments {
  std::string folder;  // folder of the experiment files
  Table1Options options;
};

// Adds the folder, --output, --seeds and --turns. The values in `arguments` are the defaults.
void AddTable1Arguments(CLI::App* command, Table1Arguments* arguments);

// 0 if every search found a usable result, otherwise 1.
int ExitCode(const Table1Result& result);

}  // namespace lacuna

#endif  // LACUNA_APP_TABLE1_ARGUMENTS_H_
