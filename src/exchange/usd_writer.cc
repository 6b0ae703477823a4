#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <vector>

#include "exchange/inp_writer.h"
#include "exchange/scene_writers.h"

namespace lacuna {
namespace {

using How = Counterpart::Kind;

std::string Quoted(std::string text) {
  for (char& letter : text)
    if (letter == '"' || letter == '\\' || letter == '\n') letter = '\'';
  return '"' + text + '"';
}

}  // namespace

Counterparts UsdCounterparts(const PortableModel& model) {
  Counterparts parts;
  if (model.mesh.Order() == 2)
    parts.push_back(
        {"quadratic elements", How::kNone, "linear ones of the corner nodes are written"});
  for (const PortableEffect& effect : model.effects)
    parts.push_back({effect.name, How::kNone,
                     "no schema of USD describes it; its values are custom attributes lacuna:*"});
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, How::kNone,
                     "its nodes are a custom attribute lacuna:nodes:*, its motion is left out"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kNone, "only its nodes are written"});
  return parts;
}

std::string UsdText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  const BoundarySurface boundary = ExtractBoundary(model.mesh);
  std::string text =
      "#usda 1.0\n(\n    defaultPrim = \"body\"\n    metersPerUnit = 1\n    kilogramsPerUnit = 1\n"
      "    upAxis = \"Z\"\n)\n" +
      FileComment(given, UsdCounterparts(given), "# ") +
      "def TetMesh \"body\" (\n    prepend apiSchemas = [\"PhysicsMassAPI\"]\n)\n{\n";
  const auto end = std::back_inserter(text);
  fmt::format_to(end, "    float physics:density = {}\n    point3f[] points = [", model.density);
  for (Eigen::Index n = 0; n < model.mesh.NodeCount(); ++n) {
    const Eigen::Vector3f node = model.mesh.nodes.col(n).cast<float>();
    fmt::format_to(end, "{}({}, {}, {})", n == 0 ? "" : ", ", node.x(), node.y(), node.z());
  }
  text += "]\n    int4[] tetVertexIndices = [";
  for (Eigen::Index e = 0; e < model.mesh.TetCount(); ++e)
    fmt::format_to(end, "{}({})", e == 0 ? "" : ", ",
                   fmt::join(Eigen::VectorXi(model.mesh.tets.col(e)), ", "));
  text += "]\n    int3[] surfaceFaceVertexIndices = [";
  for (Eigen::Index f = 0; f < boundary.faces.cols(); ++f)
    fmt::format_to(end, "{}({})", f == 0 ? "" : ", ",
                   fmt::join(Eigen::VectorXi(boundary.faces.col(f)), ", "));
  text += "]\n";
  for (size_t k = 0; k < model.effects.size(); ++k) {
    const PortableEffect& effect = model.effects[k];
    fmt::format_to(end, "    custom string lacuna:effect{}:type = {}\n", k + 1,
                   Quoted(effect.name));
    for (Eigen::Index p = 0; p < effect.values.size(); ++p)
      fmt::format_to(end, "    custom double lacuna:effect{}:{} = {}\n", k + 1,
                     effect.value_names[static_cast<size_t>(p)], effect.values[p]);
  }
  const std::vector<std::string> names = InpSetNames(model.regions);
  for (size_t k = 0; k < names.size(); ++k)
    fmt::format_to(end, "    custom int[] lacuna:nodes:{} = [{}]\n", names[k],
                   fmt::join(model.regions[k].nodes, ", "));
  return text + "}\n";
}

}  // namespace lacuna
