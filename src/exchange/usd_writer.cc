#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <optional>
#include <vector>

#include "core/error.h"
#include "exchange/scene_writers.h"
#include "exchange/unique_names.h"
#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;

// The root prim, and the names of its children that are the same in every file.
constexpr const char* kRoot = "lacuna";
constexpr const char* kScene = "scene";
constexpr const char* kMaterial = "material";
constexpr const char* kBody = "body";

Counterpart UsdEffect(const PortableEffect& effect) {
  switch (effect.kind) {
    case Kind::kLinear:
      return {effect.name, How::kConverted,
              "Young's modulus and Poisson's ratio of the material; the schema leaves the law to "
              "the simulator: agrees for small strains and rotations"};
    case Kind::kCorotational:
    case Kind::kSaintVenantKirchhoff:
    case Kind::kNeoHookean:
      return {effect.name, How::kConverted,
              "Young's modulus and Poisson's ratio of the material; the schema leaves the law to "
              "the simulator: agrees to first order in the strain"};
    case Kind::kGravity:
      return {effect.name, How::kExact, "PhysicsScene"};
    default:
      return {effect.name, How::kNone,
              "no schema describes it; its values are custom attributes lacuna:*"};
  }
}

// The poses of a grip that moves as a rigid body, to the single precision of the points; the rest
// shape has the identity. None for any other motion; empty for a grip at rest.
std::optional<std::vector<Eigen::Isometry3d>> RigidPoses(const PortableGrip& grip,
                                                         const TetMesh& mesh) {
  const double size =
      (mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).maxCoeff();
  const Eigen::Matrix3Xd rest = mesh.nodes(Eigen::all, grip.part.nodes);
  std::vector<Eigen::Isometry3d> poses;
  for (const Eigen::Matrix3Xd& displacement : grip.displacements) {
    const Eigen::Matrix3Xd moved = rest + displacement;
    poses.push_back(FitRigidMotion(rest, moved).motion);
    const Eigen::Matrix3Xd difference = poses.back() * rest - moved;
    if (difference.size() == 0 || difference.cwiseAbs().maxCoeff() > 1e-7 * size)
      return std::nullopt;
  }
  return poses;
}

Counterpart GripCounterpart(const PortableGrip& grip, const TetMesh& mesh) {
  const std::string part = "grip " + grip.part.name;
  if (!grip.axes.IsAll()) return {part, How::kNone, "an attachment holds along all axes"};
  if (!RigidPoses(grip, mesh))
    return {part, How::kNone, "a motion that is not that of a rigid body"};
  return {
      part, How::kExact,
      grip.displacements.empty()
          ? "PhysicsAttachment to an Xform"
          : "PhysicsAttachment to a kinematic rigid body, linear between times at most one time "
            "step apart"};
}

std::string Quoted(std::string text) {
  text = CommentText(text);
  for (char& letter : text)
    if (letter == '"' || letter == '\\') letter = '\'';
  return '"' + text + '"';
}

// The columns as an array: "[(0, 1, 2), (3, 4, 5)]".
template <typename Matrix>
std::string Tuples(const Matrix& columns) {
  std::string text;
  for (const auto column : columns.colwise())
    fmt::format_to(std::back_inserter(text), "{}({})", text.empty() ? "" : ", ",
                   fmt::join(column.begin(), column.end(), ", "));
  return "[" + text + "]";
}

// USD multiplies row vectors from the left, so that the translation is the last row.
std::string MatrixText(const Eigen::Isometry3d& pose) {
  std::string text = Tuples(pose.matrix());
  text.front() = '(';
  text.back() = ')';
  return text;
}

class UsdWriter {
 public:
  explicit UsdWriter(const PortableModel& linear) : model_(linear) {}

  // All that follows the comment at the top.
  std::string Root() {
    std::string text =
        fmt::format("def Xform \"{}\"\n{{\n", kRoot) + Effects() + Scene() + Material() + Body();
    for (const PortableGrip& grip : model_.grips) text += Grip(grip);
    return text + "}\n";
  }

 private:
  std::string Effects() const {
    std::string text;
    for (size_t k = 0; k < model_.effects.size(); ++k) {
      const PortableEffect& effect = model_.effects[k];
      text +=
          fmt::format("    custom string lacuna:effect{}:type = {}\n", k + 1, Quoted(effect.name));
      for (Eigen::Index p = 0; p < effect.values.size(); ++p)
        text += fmt::format("    custom double lacuna:effect{}:{} = {}\n", k + 1,
                            effect.value_names[static_cast<size_t>(p)], effect.values[p]);
    }
    return text;
  }

  // Without a direction or magnitude a simulator would take the earth's gravity.
  std::string Scene() const {
    const Eigen::Vector3f gravity = model_.Gravity().cast<float>();
    const Eigen::Vector3f direction =
        gravity.isZero(0) ? Eigen::Vector3f(-Eigen::Vector3f::UnitZ()) : gravity.normalized();
    return fmt::format(
        "\n    def PhysicsScene \"{}\"\n    {{\n"
        "        vector3f physics:gravityDirection = ({}, {}, {})\n"
        "        float physics:gravityMagnitude = {}\n    }}\n",
        kScene, direction.x(), direction.y(), direction.z(), gravity.norm());
  }

  std::string Material() const {
    const Eigen::VectorXf values = model_.Elasticity().values.cast<float>();
    return fmt::format(
        "\n    def Material \"{}\" (\n"
        "        prepend apiSchemas = [\"PhysicsMaterialAPI\", "
        "\"PhysicsVolumeDeformableMaterialAPI\"]\n    )\n    {{\n"
        "        float physics:density = {}\n        float physics:poissonsRatio = {}\n"
        "        float physics:youngsModulus = {}\n    }}\n",
        kMaterial, static_cast<float>(model_.density), values[1], values[0]);
  }

  std::string Body() const {
    const Eigen::Matrix3Xf points = model_.mesh.nodes.cast<float>();
    Eigen::Matrix<float, 3, 2> extent;
    extent << points.rowwise().minCoeff(), points.rowwise().maxCoeff();
    std::string text = fmt::format(
        "\n    def TetMesh \"{}\" (\n"
        "        prepend apiSchemas = [\"PhysicsDeformableBodyAPI\", "
        "\"PhysicsVolumeDeformableSimAPI\", \"MaterialBindingAPI\"]\n    )\n    {{\n"
        "        float3[] extent = {}\n"
        "        rel material:binding:physics = </{}/{}>\n"
        "        uniform token orientation = \"rightHanded\"\n"
        "        rel physics:simulationOwner = </{}/{}>\n"
        "        point3f[] points = {}\n"
        "        uniform token subsetFamily:region:familyType = \"unrestricted\"\n"
        "        int3[] surfaceFaceVertexIndices = {}\n"
        "        int4[] tetVertexIndices = {}\n",
        kBody, Tuples(extent), kRoot, kMaterial, kRoot, kScene, Tuples(points),
        Tuples(ExtractBoundary(model_.mesh).faces), Tuples(model_.mesh.tets));
    UniqueNames names;
    for (const NamedNodes& region : model_.regions)
      text += fmt::format(
          "\n        def GeomSubset \"{}\" (\n            displayName = {}\n        )\n        {{\n"
          "            uniform token elementType = \"point\"\n"
          "            uniform token familyName = \"region\"\n"
          "            int[] indices = [{}]\n        }}\n",
          names.Add(Identifier(region.name)), Quoted(region.name), fmt::join(region.nodes, ", "));
    return text + "    }\n";
  }

  // The nodes are attached to a frame that has their motion.
  std::string Grip(const PortableGrip& grip) {
    const std::optional<std::vector<Eigen::Isometry3d>> poses = RigidPoses(grip, model_.mesh);
    if (!grip.axes.IsAll() || !poses) return "";
    const std::string name = names_.Add(Identifier(grip.part.name));
    std::string text = fmt::format("\n    def Xform \"{}\" (\n", name);
    if (!poses->empty()) text += "        prepend apiSchemas = [\"PhysicsRigidBodyAPI\"]\n";
    text += fmt::format("        displayName = {}\n    )\n    {{\n", Quoted(grip.part.name));
    if (!poses->empty()) {
      text +=
          "        bool physics:kinematicEnabled = 1\n"
          "        matrix4d xformOp:transform.timeSamples = {\n";
      for (size_t k = 0; k < poses->size(); ++k)
        text += fmt::format("            {}: {},\n", model_.times[k], MatrixText((*poses)[k]));
      text += "        }\n        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n\n";
    }
    const Eigen::Matrix3Xf rest = model_.mesh.nodes(Eigen::all, grip.part.nodes).cast<float>();
    return text + fmt::format(
                      "        def PhysicsAttachment \"attachment\"\n        {{\n"
                      "            vector3f[] physics:coords1 = {}\n"
                      "            int[] physics:indices0 = [{}]\n"
                      "            rel physics:src0 = </{}/{}>\n"
                      "            rel physics:src1 = </{}/{}>\n"
                      "            uniform token physics:type0 = \"point\"\n"
                      "            uniform token physics:type1 = \"xform\"\n        }}\n    }}\n",
                      Tuples(rest), fmt::join(grip.part.nodes, ", "), kRoot, kBody, kRoot, name);
  }

  const PortableModel& model_;
  UniqueNames names_{{kScene, kMaterial, kBody}};  // of the children of the root prim
};

std::string StageMetadata(const PortableModel& model) {
  return fmt::format(
      "(\n    defaultPrim = \"{}\"\n    endTimeCode = {}\n    kilogramsPerUnit = 1\n"
      "    metersPerUnit = 1\n    startTimeCode = 0\n    timeCodesPerSecond = 1\n"
      "    upAxis = \"Z\"\n)\n",
      kRoot, model.Duration());
}

}  // namespace

Counterparts UsdCounterparts(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  Counterparts parts;
  AddLostMidpoints(given, &parts);
  for (const PortableEffect& effect : model.effects) parts.push_back(UsdEffect(effect));
  for (const PortableGrip& grip : model.grips) parts.push_back(GripCounterpart(grip, model.mesh));
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kNone, "only its nodes are written"});
  if (!given.is_static)
    parts.push_back({"inertia", How::kConverted,
                     "lumped masses; the program that reads the file chooses the time scheme"});
  AddLostStart(given, &parts);
  return parts;
}

std::string UsdText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  if (!model.Elasticity().IsElasticity())
    throw InputError(model.Elasticity().name +
                     ": this elasticity law cannot be written into a USD file");
  return "#usda 1.0\n" + StageMetadata(model) + FileComment(given, UsdCounterparts(given), "# ") +
         "# The schema of the deformable body is a proposal: \"Deformable Body Physics in USD\",\n"
         "# pull request 111 of PixarAnimationStudios/OpenUSD-proposals, as of commit 584939b "
         "(2026)\n" +
         UsdWriter(model).Root();
}

}  // namespace lacuna
