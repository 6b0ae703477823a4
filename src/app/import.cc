// lacuna import MODEL.inp
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands.h"
#include "exchange/imported_experiment.h"

namespace lacuna {
namespace {

struct ImportArguments {
  std::string file, unit, output;
};

int Import(const ImportArguments& arguments) {
  const std::filesystem::path file = arguments.file;
  const std::string name = file.stem().string();
  const ImportedModel model =
      InSiUnits(ReadInp(file), arguments.unit == "mm" ? InpUnits::kMillimetre : InpUnits::kMetre);
  const std::filesystem::path output = arguments.output.empty()
                                           ? std::filesystem::path(name)
                                           : std::filesystem::path(arguments.output);
  const std::vector<std::string> written = WriteImportedExperiment(model, name, file, output);
  const Eigen::Vector3d size =
      model.mesh.nodes.rowwise().maxCoeff() - model.mesh.nodes.rowwise().minCoeff();
  fmt::print("{}: {} nodes, {} tetrahedra of order {}; {:.4g} x {:.4g} x {:.4g} m\n", file.string(),
             model.mesh.NodeCount(), model.mesh.TetCount(), model.mesh.Order(), size.x(), size.y(),
             size.z());
  for (const NamedNodes& set : model.node_sets)
    fmt::print("  node set {}: {} nodes\n", set.name, set.nodes.size());
  for (const NamedNodes& set : model.element_sets)
    fmt::print("  element set {}: {} elements\n", set.name, set.nodes.size());
  for (const ImportedMaterial& material : model.materials) {
    fmt::print("  material {}:", material.name);
    if (material.young_modulus)
      fmt::print(" E = {:.6g} Pa, nu = {:.6g}", *material.young_modulus, *material.poisson_ratio);
    if (material.density) fmt::print(" density = {:.6g} kg/m^3", *material.density);
    if (material.is_instantaneous) fmt::print("; the modulus is the instantaneous one");
    if (model.materials.size() > 1)
      fmt::print("; {}",
                 &material == MaterialOfBody(model) ? "taken for the whole body" : "not used");
    fmt::print("\n");
  }
  for (const std::string& note : model.notes) fmt::print("  note: {}\n", note);
  for (const std::string& line : model.not_read) fmt::print("  not read: {}\n", line);
  fmt::print("Written to {}:\n", output.string());
  for (const std::string& item : written) fmt::print("  {}\n", item);
  fmt::print("Complete what is marked TO DO in recording.yaml and {}.yaml.\n", name);
  return 0;
}

}  // namespace

void AddImport(CLI::App* app, std::function<int()>* command) {
  CLI::App* imported =
      app->add_subcommand("import", "Start an experiment from an Abaqus or CalculiX input file");
  imported->footer(
      "Reads the mesh, the sets and isotropic elasticity; all other keywords are listed.\n"
      "docs/export.md describes the files that are written.");
  auto arguments = std::make_shared<ImportArguments>();
  imported->add_option("file", arguments->file, "The .inp file")->required();
  imported
      ->add_option("--unit", arguments->unit,
                   "Unit of length: m (SI), or mm (with N and s: MPa, tonne/mm^3)")
      ->required()
      ->check(CLI::IsMember({"m", "mm"}));
  imported->add_option("--output", arguments->output, "Folder; default: the file's name");
  imported->callback([=] { *command = [=] { return Import(*arguments); }; });
}

}  // namespace lacuna
