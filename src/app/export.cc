// lacuna export RUN
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text_layout.h"
#include "exchange/calculix.h"
#include "exchange/described_run.h"
#include "exchange/export_format.h"

namespace lacuna {
namespace {

struct ExportArguments {
  std::string run, format, output;
  DescribedRunOptions described;
  bool allow_missing = false, verify = false;
};

bool IsVerifiable(const ExportFormat& format) { return format.name.starts_with("inp"); }

void RefuseMissing(const Counterparts& counterparts, const ExportFormat& format) {
  const Counterparts missing = Missing(counterparts);
  if (missing.empty()) return;
  std::string list;
  for (const std::string& line : CounterpartLines(missing)) list += Wrapped(line, "  ", "    ");
  throw InputError(
      fmt::format("the format {} has no counterpart for\n{}--allow-missing leaves them out",
                  format.name, list));
}

// `size`: m, of the body.
void PrintDifference(const char* what, const DisplacementDifference& difference, double size) {
  if (!difference.IsDisplaced(size)) {
    fmt::print("  {:<12} nothing moves in Lacuna; largest difference {:.2g} mm\n", what,
               1e3 * difference.largest_difference);
    return;
  }
  fmt::print("  {:<12} largest {:.3g} %, rms {:.3g} % of the largest displacement, {:.4g} mm\n",
             what, 100 * difference.largest, 100 * difference.rms,
             1e3 * difference.largest_displacement);
}

// Runs CalculiX and predicts the motion. Returns the exit status.
int Verify(const DescribedRun& run, const std::filesystem::path& output) {
  const PortableModel& model = run.model;
  const CalculixResult result =
      RunCalculix(output / "model.inp", output / "calculix", model.mesh.NodeCount(), model.frames);
  if (result.status == CalculixResult::Status::kAbsent) {
    fmt::print("Not verified: ccx is not installed (Debian package calculix-ccx).\n");
    return 0;
  }
  if (!result.IsUsable()) {
    fmt::print("Not verified: {}\n", result.message);
    return 1;
  }
  const Eigen::MatrixXd expected =
      PredictPositions(run).colwise() - Eigen::VectorXd(model.mesh.nodes.reshaped());
  const Eigen::Matrix3Xd& nodes = model.mesh.nodes;
  const double size = (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
  fmt::print("Displacements of all {} nodes, CalculiX against Lacuna:\n", model.mesh.NodeCount());
  PrintDifference("equilibrium",
                  CompareDisplacements(expected.leftCols(1), result.displacement.leftCols(1)),
                  size);
  const Eigen::Index frames = expected.cols() - 1;
  if (frames > 0)
    PrintDifference(
        "motion",
        CompareDisplacements(expected.rightCols(frames), result.displacement.rightCols(frames)),
        size);
  return 0;
}

int Export(const ExportArguments& arguments) {
  const ExportFormat& format = FindExportFormat(arguments.format);
  if (arguments.verify && !IsVerifiable(format))
    throw InputError("--verify runs CalculiX and needs --to inp or --to inp_lumped");
  const DescribedRun run = DescribeRun(arguments.run, arguments.described);
  const Counterparts counterparts = format.counterparts(run.model);
  if (!arguments.allow_missing) RefuseMissing(counterparts, format);
  const FileTexts files = format.files(run.model);
  const std::filesystem::path output =
      arguments.output.empty() ? std::filesystem::path(arguments.run) / "export" / format.name
                               : std::filesystem::path(arguments.output);
  MakeFolder(output);
  fmt::print("The parts of the model in the format {}, for {}:\n", format.name, format.program);
  for (const std::string& line : CounterpartLines(counterparts))
    fmt::print("{}", Wrapped(line, "  ", "    "));
  for (const auto& [name, text] : files) {
    WriteFileAtomically(output / name, text);
    fmt::print("Written: {}\n", (output / name).string());
  }
  return arguments.verify ? Verify(run, output) : 0;
}

}  // namespace

void AddExport(CLI::App* app, std::function<int()>* command) {
  CLI::App* exported =
      app->add_subcommand("export", "Write a fitted model in the format of another program");
  exported->footer(
      "RUN is the folder of a finished `lacuna fit`. If the format cannot express some parts of\n"
      "the model, they are listed, and nothing is written unless --allow-missing is given.\n"
      "docs/export.md describes the formats.");
  auto arguments = std::make_shared<ExportArguments>();
  exported->add_option("run", arguments->run, "Folder of the run, results/NAME")->required();
  std::string formats;
  for (const ExportFormat& format : ExportFormats())
    formats += fmt::format("{}{} ({})", formats.empty() ? "" : ", ", format.name, format.program);
  exported->add_option("--to", arguments->format, "Format: " + formats)->required();
  exported->add_option("--recording", arguments->described.recording,
                       "Recording whose grips and loads are exported; default: the first");
  exported->add_option("--until", arguments->described.until,
                       "Recorded time in s at which the motion ends; default: the last frame");
  exported->add_option("--output", arguments->output, "Folder; default: RUN/export/FORMAT");
  exported->add_flag("--allow-missing", arguments->allow_missing,
                     "Leave out what has no counterpart in the format");
  exported->add_flag("--verify", arguments->verify,
                     "Run CalculiX on the file, where it is installed, and print how much its "
                     "displacements differ; only for inp and inp_lumped");
  exported->callback([=] { *command = [=] { return Export(*arguments); }; });
}

}  // namespace lacuna
