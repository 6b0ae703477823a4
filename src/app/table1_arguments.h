// What the commands that repeat Table 1's searches take from the command line.
#ifndef LACUNA_APP_TABLE1_ARGUMENTS_H_
#define LACUNA_APP_TABLE1_ARGUMENTS_H_

#include <string>

#include "paper/table1.h"

namespace CLI {
class App;
}

namespace lacuna {

struct Table1Arguments {
  std::string folder;  // of the experiment files
  Table1Options options;
};

// The folder, --output, --seeds and --turns; what stands in `arguments` are the defaults.
void AddTable1Arguments(CLI::App* command, Table1Arguments* arguments);

// 0 where every search found something.
int ExitCode(const Table1Result& result);

}  // namespace lacuna

#endif  // LACUNA_APP_TABLE1_ARGUMENTS_H_
