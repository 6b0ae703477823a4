// The commands of the program. Each function adds one command to the command line. If that command
// is given, `*command` is set to a function that runs it and returns the exit status. Options of
// the command set `*output`, which must live until then.
#ifndef LACUNA_APP_COMMANDS_H_
#define LACUNA_APP_COMMANDS_H_

#include <functional>

#include "app/output_options.h"

namespace CLI {
class App;
}

namespace lacuna {

void AddReconstruct(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddFit(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddAdd(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddCompare(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddDiagnose(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddPlan(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddReport(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddTable1(CLI::App* app, OutputOptions* output, std::function<int()>* command);
void AddSweep(CLI::App* app, std::function<int()>* command);
void AddAblation(CLI::App* app, std::function<int()>* command);
void AddFigures(CLI::App* app, std::function<int()>* command);
void AddSimulate(CLI::App* app, std::function<int()>* command);
void AddInfo(CLI::App* app, std::function<int()>* command);
void AddValidate(CLI::App* app, std::function<int()>* command);
void AddEffects(CLI::App* app, std::function<int()>* command);
void AddExplain(CLI::App* app, std::function<int()>* command);
void AddExport(CLI::App* app, std::function<int()>* command);
void AddImport(CLI::App* app, std::function<int()>* command);

}  // namespace lacuna

#endif  // LACUNA_APP_COMMANDS_H_
