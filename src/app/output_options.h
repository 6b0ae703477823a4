// What a command prints: a short summary, everything, a record for other programs, or nothing.
#ifndef LACUNA_APP_OUTPUT_OPTIONS_H_
#define LACUNA_APP_OUTPUT_OPTIONS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"

namespace CLI {
class App;
}

namespace lacuna {

struct OutputOptions {
  bool verbose = false;  // print the whole result, and log the stages in detail
  bool quiet = false;    // print nothing but errors
  bool json = false;     // print the record of the result, and nothing else, on standard output
  bool report = true;    // write the report's page

  // Whether text for people is printed on standard output.
  bool PrintsText() const { return !quiet && !json; }
  ProgressOptions ForProgress() const;
};

// Adds --verbose, --quiet and --json.
void AddPrintOptions(CLI::App* command, OutputOptions* output);

// Adds these and --no-report, to a command that writes a report's page.
void AddOutputOptions(CLI::App* command, OutputOptions* output);

// Prints warnings on standard error, unless nothing but errors is to be printed.
void PrintWarnings(const OutputOptions& output, const std::vector<std::string>& warnings);

// Prints the file that holds the record of a result.
void PrintRecord(const std::filesystem::path& file);

// Prints sentences, each as a paragraph, in a short summary.
void PrintSentences(const OutputOptions& output, const std::vector<std::string>& sentences);

// Writes the report of a run to its default place and prints where it lies, unless there shall be
// none.
void WriteRunReport(const OutputOptions& output, const std::filesystem::path& run);

// WriteRunReport() for a run of `lacuna fit` and the models that belong to it. Where the folders
// lack the motion of a usable model, it is predicted first. Prints the headline
// (report/headline.h), too.
void WriteFitReport(const OutputOptions& output, const std::filesystem::path& run,
                    Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_APP_OUTPUT_OPTIONS_H_
