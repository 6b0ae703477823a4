#include "exchange/export_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/suggestion.h"
#include "exchange/feb_writer.h"
#include "exchange/gmsh_regions.h"
#include "exchange/inp_writer.h"
#include "exchange/model_json.h"
#include "exchange/scene_writers.h"
#include "geometry/gmsh_io.h"

namespace lacuna {
namespace {

template <InpDialect kDialect>
ExportFormat InpFormat(const char* name, const char* program) {
  return {name, program,
          [](const PortableModel& model) { return InpCounterparts(model, kDialect); },
          [](const PortableModel& model) {
            return FileTexts{{"model.inp", InpText(model, kDialect)}};
          }};
}

FileTexts GmshFiles(const PortableModel& model, GmshVersion version) {
  return {{"model.msh", GmshText(model.mesh, version) + GmshRegions(model)},
          {"model.json", ModelJson(model, "model.msh").dump(1) + "\n"}};
}

std::string LinearMesh(const PortableModel& model, GmshVersion version) {
  return GmshText(WithLinearElements(model).mesh, version);
}

}  // namespace

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats{
      InpFormat<InpDialect::kCalculix>("inp", "CalculiX"),
      InpFormat<InpDialect::kCalculixPointMasses>("inp_lumped", "CalculiX, lumped masses"),
      InpFormat<InpDialect::kAbaqus>("abaqus", "Abaqus"),
      {"feb", "FEBio 4", FebCounterparts,
       [](const PortableModel& model) {
         return FileTexts{{"model.feb", FebText(model)}};
       }},
      {"msh", "Gmsh 4.1, with model.json", JsonCounterparts,
       [](const PortableModel& model) { return GmshFiles(model, GmshVersion::k41); }},
      {"msh2", "Gmsh 2.2, with model.json", JsonCounterparts,
       [](const PortableModel& model) { return GmshFiles(model, GmshVersion::k22); }},
      {"sofa", "SOFA, with a mesh", SofaCounterparts,
       [](const PortableModel& model) {
         return FileTexts{{"model.py", SofaText(model)},
                          {"model.msh", LinearMesh(model, GmshVersion::k22)}};
       }},
      {"mjcf", "MuJoCo, with a mesh", MujocoCounterparts,
       [](const PortableModel& model) {
         return FileTexts{{"model.xml", MujocoText(model)},
                          {"model.msh", LinearMesh(model, GmshVersion::k41)}};
       }},
      {"usda", "USD, a TetMesh", UsdCounterparts,
       [](const PortableModel& model) {
         return FileTexts{{"model.usda", UsdText(model)}};
       }},
  };
  return formats;
}

const ExportFormat& FindExportFormat(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : ExportFormats()) {
    if (format.name == name) return format;
    names.push_back(format.name);
  }
  throw InputError(fmt::format("there is no format \"{}\"{}; the formats: {}", name,
                               Suggestion(name, names), fmt::join(names, ", ")));
}

}  // namespace lacuna
