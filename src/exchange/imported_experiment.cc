#include "exchange/imported_experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <optional>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_name.h"
#include "core/quoted_text.h"
#include "effects/standard_cards.h"
#include "exchange/counterpart.h"
#include "exchange/unique_names.h"
#include "geometry/mesh_io.h"

namespace lacuna {
namespace {

// Values of a soft rubber, written with the mark TO DO where the file does not have its own.
constexpr double kSoftModulus = 1e5;  // Pa
constexpr double kSoftPoisson = 0.45;
constexpr double kWaterDensity = 1000;  // kg/m³

constexpr const char* kRecordingFile = "recording.yaml";

void RequireUsableName(const std::string& name, const std::filesystem::path& source) {
  if (!IsFileName(name))
    throw InputError({source.string()},
                     "the experiment is named after the file, so that its name must not begin with "
                     "a dot or contain a backslash or a control character; rename it");
  if (name + ".yaml" == kRecordingFile)
    throw InputError({source.string()},
                     fmt::format("the experiment is named after the file, but {} describes the "
                                 "recording; rename it",
                                 kRecordingFile));
}

// For each node set the name of its region, which is also part of the name of a file.
std::vector<std::string> RegionNames(const ImportedModel& model) {
  UniqueNames taken;
  std::vector<std::string> names;
  for (const NamedNodes& set : model.node_sets) names.push_back(taken.Add(Identifier(set.name)));
  return names;
}

std::string RegionsText(const ImportedModel& model, const std::vector<std::string>& names) {
  if (names.empty()) return "#   the file has no node sets\n";
  std::string text = "# fixed:\n";
  for (size_t k = 0; k < names.size(); ++k) {
    const std::string& set = model.node_sets[k].name;
    text += fmt::format("#   - {{name: {0}, nodes_file: nodes_{0}.txt}}", names[k]);
    text += set == names[k] ? "\n" : fmt::format("   # {} in the file\n", CommentText(set));
  }
  return text;
}

std::string RecordingText(const ImportedModel& model, const std::string& name,
                          const std::string& source, const std::vector<std::string>& regions) {
  std::string text = fmt::format(
      "# Made from {}. Complete what is marked TO DO; docs/recording.md has the keys.\n"
      "schema_version: 1\nname: {}\nlength_unit: m                    # TO DO: of the numbers in "
      "your files\n"
      "frames:                           # TO DO: your measurements; this is a marker file\n"
      "  kind: markers\n  file: markers.csv\n"
      "  columns: {{time: t, x: \"*_x\", y: \"*_y\", z: \"*_z\"}}\n"
      "  marker_places:                  # TO DO: each marker's position on the undeformed object\n"
      "    - {{name: tip, position: [{} m, {} m, {} m]}}\n"
      "reference: {{from: tet_mesh, file: {}, length_unit: m}}\n",
      source, QuotedText(name), model.mesh.nodes(0, 0), model.mesh.nodes(1, 0),
      model.mesh.nodes(2, 0), QuotedText(name + ".msh"));
  text +=
      "# TO DO: use the node sets where they belong: parts that do not move (fixed), parts that\n"
      "# are moved (gripped), or the regions of measured forces.\n";
  return text + RegionsText(model, regions);
}

bool HasElasticity(const ImportedMaterial* material) {
  return material != nullptr && material->young_modulus.has_value();
}

double ModulusOf(const ImportedMaterial* material) {
  return HasElasticity(material) ? *material->young_modulus : kSoftModulus;
}

constexpr const char* kNotInFile = "   # TO DO: not in the file\n";

std::string DensityText(const ImportedMaterial* material) {
  const bool is_known = material != nullptr && material->density.has_value();
  return fmt::format("density: {} kg/m^3{}", is_known ? *material->density : kWaterDensity,
                     is_known ? "\n" : kNotInFile);
}

// Why the material may not be that of the whole body; empty where it is.
std::string DoubtOfMaterial(const ImportedMaterial& material, const ImportedModel& model) {
  const auto elements = static_cast<size_t>(model.mesh.TetCount());
  const std::string name = CommentText(material.name);
  if (material.element_count > 0 && material.element_count < elements)
    return fmt::format("{} of {} elements have {}, which is taken for the whole body",
                       material.element_count, elements, name);
  if (material.element_count == 0 && model.materials.size() > 1)
    return fmt::format("the file has {} materials; that of {} is taken for the whole body",
                       model.materials.size(), name);
  return "";
}

std::string MaterialText(const ImportedMaterial* material, const ImportedModel& model) {
  const bool is_known = HasElasticity(material);
  std::string text = fmt::format("material: {{law: {}, young_modulus: {} Pa, poisson_ratio: {}}}",
                                 SaintVenantKirchhoffCard().type, ModulusOf(material),
                                 is_known ? *material->poisson_ratio : kSoftPoisson);
  if (!is_known) return text + kNotInFile;
  std::vector<std::string> doubts;
  if (std::string doubt = DoubtOfMaterial(*material, model); !doubt.empty())
    doubts.push_back(std::move(doubt));
  if (material->is_instantaneous)
    doubts.emplace_back("the modulus of the shortest times (MODULI=INSTANTANEOUS), which relaxes");
  if (!doubts.empty()) text += fmt::format("   # TO DO: {}", fmt::join(doubts, "; "));
  return text + "\n";
}

std::string ExperimentText(const ImportedModel& model, const std::string& name,
                           const std::string& source) {
  const ImportedMaterial* material = MaterialOfBody(model);
  std::string text = fmt::format(
      "# Made from {}. docs/prediction.md has the keys.\n"
      "#   lacuna fit {}.yaml\n"
      "schema_version: 1\nname: {}\noutput: {}\n",
      source, name, QuotedText(name), QuotedText(name + "_run"));
  text += DensityText(material) + MaterialText(material, model);
  for (const ImportedMaterial& other : model.materials)
    if (&other != material)
      text += fmt::format("# The file has another material, {}, which is not used\n",
                          CommentText(other.name));
  // The mesh is given, so that its settings only say which order of elements is used.
  text += fmt::format(
      "mesh: {{max_volume: 1 m^3, order: {}}}   # the elements of the file are used as they are\n"
      "effects: []                       # TO DO: gravity, for instance; lacuna effects lists "
      "all\n",
      model.mesh.Order());
  const double start = ModulusOf(material);
  text += fmt::format(
      "fit:\n  parameters:\n    - {{name: young_modulus, min: {} Pa, max: {} Pa}}\n"
      "recordings:\n  - recording: .                  # the recording.yaml beside this file\n"
      "    # fit_until: 1 s              # TO DO: hold out the later frames\n",
      start / 10, start * 10);
  if (!model.not_read.empty()) {
    text += fmt::format("# Not read from {}:\n", source);
    for (const std::string& line : model.not_read) text += "#   " + CommentText(line) + "\n";
  }
  return text;
}

}  // namespace

ImportedModel InSiUnits(ImportedModel model, InpUnits units) {
  if (units == InpUnits::kMetre) return model;
  model.mesh.nodes *= 1e-3;
  for (ImportedMaterial& material : model.materials) {
    if (material.young_modulus) *material.young_modulus *= 1e6;
    if (material.density) *material.density *= 1e12;
  }
  return model;
}

const ImportedMaterial* MaterialOfBody(const ImportedModel& model) {
  const ImportedMaterial* of_most = nullptr;
  for (const ImportedMaterial& material : model.materials)
    if (material.element_count > (of_most == nullptr ? 0 : of_most->element_count))
      of_most = &material;
  if (of_most != nullptr) return of_most;
  for (const ImportedMaterial& material : model.materials)
    if (material.young_modulus) return &material;
  return model.materials.empty() ? nullptr : &model.materials.front();
}

std::vector<std::string> WriteImportedExperiment(const ImportedModel& model,
                                                 const std::string& name,
                                                 const std::filesystem::path& source,
                                                 const std::filesystem::path& folder) {
  RequireUsableName(name, source);
  const std::vector<std::string> regions = RegionNames(model);
  const std::string read = CommentText(source.filename().string());
  std::map<std::string, std::string> texts{
      {kRecordingFile, RecordingText(model, name, read, regions)},
      {name + ".yaml", ExperimentText(model, name, read)}};
  for (size_t k = 0; k < regions.size(); ++k)
    texts[fmt::format("nodes_{}.txt", regions[k])] =
        fmt::format("{}\n", fmt::join(model.node_sets[k].nodes, "\n"));
  MakeFolder(folder);
  const std::string mesh = name + ".msh";
  std::vector<std::string> written{mesh};
  for (const auto& [file, text] : texts) written.push_back(file);
  for (const std::string& file : written)
    if (std::filesystem::exists(folder / file))
      throw InputError({(folder / file).string()}, "exists already; choose another --output");
  WriteTetMesh(folder / mesh, model.mesh);
  for (const auto& [file, text] : texts) WriteFileAtomically(folder / file, text);
  return written;
}

}  // namespace lacuna
