#include "exchange/usd_rules.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "exchange/usd_layer.h"

namespace lacuna {
namespace {

using Kind = UsdValue::Kind;
using Declarations = std::map<std::string, std::string>;  // of properties, by name
using Face = std::array<int, 3>;

const std::map<std::string, Declarations> kPrimTypes = {
    {"Xform", {{"xformOp:transform", "matrix4d"}, {"xformOpOrder", "uniform token[]"}}},
    {"TetMesh",
     {{"extent", "float3[]"},
      {"orientation", "uniform token"},
      {"points", "point3f[]"},
      {"subsetFamily:region:familyType", "uniform token"},
      {"surfaceFaceVertexIndices", "int3[]"},
      {"tetVertexIndices", "int4[]"},
      {"velocities", "vector3f[]"}}},
    {"GeomSubset",
     {{"elementType", "uniform token"}, {"familyName", "uniform token"}, {"indices", "int[]"}}},
    {"Material", {}},
    {"PhysicsScene",
     {{"physics:gravityDirection", "vector3f"}, {"physics:gravityMagnitude", "float"}}},
    {"PhysicsAttachment",
     {{"physics:attachmentEnabled", "bool"},
      {"physics:src0", "rel"},
      {"physics:src1", "rel"},
      {"physics:type0", "uniform token"},
      {"physics:type1", "uniform token"},
      {"physics:indices0", "int[]"},
      {"physics:indices1", "int[]"},
      {"physics:coords0", "vector3f[]"},
      {"physics:coords1", "vector3f[]"},
      {"physics:stiffness", "float"},
      {"physics:damping", "float"}}},
};

// With the properties of the API schemas that they apply themselves.
const std::map<std::string, Declarations> kApiSchemas = {
    {"MaterialBindingAPI", {{"material:binding", "rel"}, {"material:binding:physics", "rel"}}},
    {"PhysicsMaterialAPI",
     {{"physics:density", "float"},
      {"physics:dynamicFriction", "float"},
      {"physics:staticFriction", "float"},
      {"physics:restitution", "float"}}},
    {"PhysicsVolumeDeformableMaterialAPI",
     {{"physics:youngsModulus", "float"}, {"physics:poissonsRatio", "float"}}},
    {"PhysicsDeformableBodyAPI",
     {{"physics:mass", "float"},
      {"physics:density", "float"},
      {"physics:bodyEnabled", "bool"},
      {"physics:kinematicEnabled", "bool"},
      {"physics:simulationOwner", "rel"},
      {"physics:startsAsleep", "uniform bool"}}},
    {"PhysicsVolumeDeformableSimAPI",
     {{"physics:masses", "float[]"},
      {"physics:masses:elementType", "uniform token"},
      {"physics:restShapePoints", "point3f[]"},
      {"physics:restTetVertexIndices", "int4[]"}}},
    {"PhysicsRigidBodyAPI",
     {{"physics:rigidBodyEnabled", "bool"},
      {"physics:kinematicEnabled", "bool"},
      {"physics:simulationOwner", "rel"},
      {"physics:velocity", "vector3f"},
      {"physics:angularVelocity", "vector3f"}}},
};

// The type of prim to which a relationship leads.
const std::map<std::string, std::string> kTargets = {{"material:binding:physics", "Material"},
                                                     {"physics:simulationOwner", "PhysicsScene"},
                                                     {"physics:src0", "TetMesh"},
                                                     {"physics:src1", "Xform"}};

// The number of components of the types that are tuples.
const std::map<std::string, size_t> kComponents = {
    {"float3", 3}, {"point3f", 3}, {"vector3f", 3}, {"int3", 3}, {"int4", 4}};

bool HasType(const UsdValue& value, const std::string& type) {
  if (type.ends_with("[]"))
    return value.kind == Kind::kArray &&
           std::all_of(value.items.begin(), value.items.end(), [&](const UsdValue& item) {
             return HasType(item, type.substr(0, type.size() - 2));
           });
  if (type == "rel") return value.kind == Kind::kPath;
  if (type == "token" || type == "string") return value.kind == Kind::kText;
  if (type == "matrix4d")
    return value.kind == Kind::kTuple && value.items.size() == 4 &&
           std::all_of(value.items.begin(), value.items.end(), [](const UsdValue& row) {
             return row.kind == Kind::kTuple && row.items.size() == 4 && row.Numbers().size() == 4;
           });
  if (const auto tuple = kComponents.find(type); tuple != kComponents.end())
    return value.kind == Kind::kTuple && value.items.size() == tuple->second &&
           std::all_of(value.items.begin(), value.items.end(), [&](const UsdValue& item) {
             return HasType(item, type.starts_with("int") ? "int" : "float");
           });
  if (value.kind != Kind::kNumber) return false;
  const double number = value.number;
  if (type == "double") return true;
  if (type == "float") return std::abs(number) <= std::numeric_limits<float>::max();
  if (type == "bool") return number == 0 || number == 1;
  return type == "int" && number == std::floor(number) && std::abs(number) < 2147483648.0;
}

bool IsName(const std::string& text) {
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) == 0 &&
         std::all_of(text.begin(), text.end(), [](unsigned char letter) {
           return letter == '_' || (letter < 128 && std::isalnum(letter) != 0);
         });
}

Face Sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

// Whether one is the other turned, with the same sense of rotation.
bool IsTurned(const Face& a, const Face& b) {
  for (size_t k = 0; k < 3; ++k)
    if (a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3]) return true;
  return false;
}

class UsdCheck {
 public:
  explicit UsdCheck(UsdLayer layer) : layer_(std::move(layer)) {}

  std::vector<std::string> Faults() {
    Stage();
    for (const UsdPrim& prim : layer_.prims) Prim(prim, nullptr);
    if (!faults_.empty()) return faults_;
    for (const UsdPrim* prim : layer_.All()) {
      if (prim->type == "TetMesh") Mesh(*prim);
      if (prim->type == "PhysicsAttachment") Attachment(*prim);
      if (prim->Has("PhysicsVolumeDeformableMaterialAPI")) Material(*prim);
      if (prim->Has("PhysicsDeformableBodyAPI")) Body(*prim);
      if (prim->type == "Xform") Frame(*prim);
    }
    return faults_;
  }

 private:
  void Fault(const std::string& sentence) { faults_.push_back(sentence); }

  double StageNumber(const std::string& key) {
    const auto found = layer_.metadata.find(key);
    if (found != layer_.metadata.end() && found->second.kind == Kind::kNumber)
      return found->second.number;
    Fault("the stage has no number " + key);
    return 0;
  }

  std::string StageText(const std::string& key) {
    const auto found = layer_.metadata.find(key);
    if (found != layer_.metadata.end() && found->second.kind == Kind::kText)
      return found->second.text;
    Fault("the stage has no text " + key);
    return "";
  }

  void Stage() {
    for (const char* key : {"metersPerUnit", "kilogramsPerUnit", "timeCodesPerSecond"})
      if (StageNumber(key) <= 0) Fault(fmt::format("{} is not positive", key));
    start_ = StageNumber("startTimeCode");
    end_ = StageNumber("endTimeCode");
    const std::string up = StageText("upAxis");
    if (up != "Y" && up != "Z") Fault("upAxis is " + up);
    const UsdPrim* root = layer_.Find("/" + StageText("defaultPrim"));
    if (root == nullptr || root->type != "Xform") Fault("defaultPrim is no Xform at the root");
  }

  // The declaration of a property by the schemas of a prim.
  static std::optional<std::string> Declared(const UsdPrim& prim, const std::string& property) {
    const Declarations& of_type = kPrimTypes.at(prim.type);
    if (const auto found = of_type.find(property); found != of_type.end()) return found->second;
    for (const auto& [schema, declarations] : kApiSchemas)
      if (const auto found = declarations.find(property);
          found != declarations.end() && prim.Has(schema))
        return found->second;
    return std::nullopt;
  }

  void Prim(const UsdPrim& prim, const UsdPrim* parent) {
    if (!IsName(prim.name)) Fault(prim.path + " is no name");
    if (!kPrimTypes.contains(prim.type)) return Fault(prim.path + " has an unknown type");
    const bool is_below_mesh = parent != nullptr && parent->type == "TetMesh";
    if (is_below_mesh != (prim.type == "GeomSubset"))
      Fault(prim.path + " may not stand below " + (parent == nullptr ? "the root" : parent->path));
    if (parent != nullptr && parent->type == "Material") Fault(prim.path + " is below a material");
    if (const auto found = prim.metadata.find("apiSchemas"); found != prim.metadata.end())
      for (const std::string& schema : found->second.Texts())
        if (!kApiSchemas.contains(schema)) Fault(schema + " is no API schema");
    for (const UsdProperty& property : prim.properties) Property(prim, property);
    for (const UsdPrim& child : prim.children) Prim(child, &prim);
  }

  void Property(const UsdPrim& prim, const UsdProperty& property) {
    const std::string name = prim.path + "." + property.name;
    const std::string declaration = (property.is_uniform ? "uniform " : "") + property.type;
    if (!property.is_custom && Declared(prim, property.name) != declaration)
      Fault(name + " is not declared as " + declaration);
    const UsdValue& value = property.value;
    if (value.kind == Kind::kSamples) {
      if (property.is_uniform) Fault(name + " may not change in time");
      if (!std::is_sorted(value.times.begin(), value.times.end(), std::less_equal<>()) ||
          value.times.empty() || value.times.front() < start_ || value.times.back() > end_)
        Fault(name + " has times that do not ascend from the start of the stage to its end");
      for (const UsdValue& item : value.items)
        if (!HasType(item, property.type)) Fault(name + " is no " + property.type);
      return;
    }
    if (!HasType(value, property.type)) Fault(name + " is no " + property.type);
    if (property.type != "rel") return;
    const UsdPrim* target = layer_.Find(value.text);
    const auto type = kTargets.find(property.name);
    if (target == nullptr || (type != kTargets.end() && target->type != type->second))
      Fault(name + " leads to no such prim");
  }

  static std::vector<int> Integers(const UsdPrim& prim, const std::string& property) {
    const UsdProperty* found = prim.Find(property);
    if (found == nullptr) return {};
    const std::vector<double> numbers = found->value.Numbers();
    return {numbers.begin(), numbers.end()};
  }

  static std::vector<Eigen::Vector3d> Points(const UsdPrim& prim, const std::string& property) {
    std::vector<Eigen::Vector3d> points;
    const UsdProperty* found = prim.Find(property);
    if (found == nullptr) return points;
    for (const UsdValue& item : found->value.items)
      points.emplace_back(item.items[0].number, item.items[1].number, item.items[2].number);
    return points;
  }

  void InRange(const std::vector<int>& indices, size_t count, const std::string& what) {
    for (const int index : indices)
      if (index < 0 || static_cast<size_t>(index) >= count)
        return Fault(fmt::format("{} has the index {}", what, index));
  }

  void Mesh(const UsdPrim& mesh) {
    const std::vector<Eigen::Vector3d> points = Points(mesh, "points");
    const std::vector<int> tets = Integers(mesh, "tetVertexIndices");
    const std::vector<int> faces = Integers(mesh, "surfaceFaceVertexIndices");
    const size_t before = faults_.size();
    if (points.empty() || tets.empty() || faces.empty()) Fault(mesh.path + " has no mesh");
    if (mesh.Text("orientation") != "rightHanded") Fault(mesh.path + " has another orientation");
    InRange(tets, points.size(), mesh.path + ".tetVertexIndices");
    InRange(faces, points.size(), mesh.path + ".surfaceFaceVertexIndices");
    if (faults_.size() > before) return;
    Extent(mesh, points);
    Surface(points, tets, faces);
    for (const UsdPrim& subset : mesh.children) Subset(subset, mesh, points.size());
  }

  void Extent(const UsdPrim& mesh, const std::vector<Eigen::Vector3d>& points) {
    const std::vector<Eigen::Vector3d> extent = Points(mesh, "extent");
    Eigen::Vector3d low = points[0], high = points[0];
    for (const Eigen::Vector3d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    if (extent.size() != 2 || extent[0] != low || extent[1] != high)
      Fault(mesh.path + ".extent is not the bounding box");
  }

  // A face of one tetrahedron only is a face of the surface.
  void Surface(const std::vector<Eigen::Vector3d>& points, const std::vector<int>& tets,
               const std::vector<int>& faces) {
    // The faces of a tetrahedron, seen from outside (UsdGeomTetMesh, "rightHanded").
    constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    std::map<Face, std::vector<Face>> of_tets;
    for (size_t t = 0; t + 3 < tets.size(); t += 4) {
      const auto at = [&](size_t k) { return points[static_cast<size_t>(tets[t + k])]; };
      const Eigen::Vector3d a = at(1) - at(0), b = at(2) - at(0), c = at(3) - at(0);
      if (a.cross(b).dot(c) <= 0) Fault(fmt::format("tetrahedron {} is inverted", t / 4));
      for (const auto& face : kFaces) {
        const Face nodes{tets[t + static_cast<size_t>(face[0])],
                         tets[t + static_cast<size_t>(face[1])],
                         tets[t + static_cast<size_t>(face[2])]};
        of_tets[Sorted(nodes)].push_back(nodes);
      }
    }
    size_t outer = 0;
    for (const auto& [sorted, same] : of_tets) outer += same.size() == 1 ? 1 : 0;
    std::set<Face> seen;
    for (size_t f = 0; f + 2 < faces.size(); f += 3) {
      const Face face{faces[f], faces[f + 1], faces[f + 2]};
      const auto found = of_tets.find(Sorted(face));
      if (found == of_tets.end() || found->second.size() != 1 ||
          !IsTurned(face, found->second[0]) || !seen.insert(Sorted(face)).second)
        Fault(fmt::format("face {} of the surface is not an outer one that looks outwards", f / 3));
    }
    if (seen.size() != outer) Fault("the surface is not closed");
  }

  void Subset(const UsdPrim& subset, const UsdPrim& mesh, size_t points) {
    const std::vector<int> indices = Integers(subset, "indices");
    InRange(indices, points, subset.path);
    if (std::set<int>(indices.begin(), indices.end()).size() != indices.size())
      Fault(subset.path + " has an index twice");
    if (subset.Text("elementType") != "point") Fault(subset.path + " has no points");
    const std::string family = "subsetFamily:" + subset.Text("familyName") + ":familyType";
    if (mesh.Text(family) != "unrestricted") Fault(subset.path + " has a family of no type");
  }

  void Material(const UsdPrim& material) {
    const auto value = [&](const char* name) {
      const UsdProperty* found = material.Find(name);
      return found == nullptr ? std::nan("") : found->value.number;
    };
    if (!(value("physics:youngsModulus") >= 0)) Fault("youngsModulus is not in [0, inf)");
    if (!(value("physics:poissonsRatio") > -1 && value("physics:poissonsRatio") <= 0.5))
      Fault("poissonsRatio is not in (-1, 0.5]");
    if (!(value("physics:density") > 0)) Fault("density is not positive");
  }

  void Body(const UsdPrim& body) {
    int count = body.Has("PhysicsVolumeDeformableSimAPI") ? 1 : 0;
    for (const UsdPrim& child : body.children)
      count += child.Has("PhysicsVolumeDeformableSimAPI") ? 1 : 0;
    if (count != 1) Fault(body.path + " has not one mesh to simulate");
    if (body.Has("PhysicsRigidBodyAPI")) Fault(body.path + " is rigid, too");
    const UsdPrim* material = layer_.Find(body.Text("material:binding:physics"));
    if (material == nullptr || !material->Has("PhysicsVolumeDeformableMaterialAPI"))
      Fault(body.path + " has no deformable material");
  }

  void Attachment(const UsdPrim& attachment) {
    const UsdPrim* body = layer_.Find(attachment.Text("physics:src0"));
    const UsdPrim* frame = layer_.Find(attachment.Text("physics:src1"));
    if (body == nullptr || frame == nullptr || !body->Has("PhysicsVolumeDeformableSimAPI"))
      return Fault(attachment.path + " has not a body and a frame");
    if (attachment.Text("physics:type0") != "point" || attachment.Text("physics:type1") != "xform")
      Fault(attachment.path + " has other types than point and xform");
    const std::vector<int> indices = Integers(attachment, "physics:indices0");
    InRange(indices, Points(*body, "points").size(), attachment.path + ".indices0");
    if (indices.empty() || Points(attachment, "physics:coords1").size() != indices.size())
      Fault(attachment.path + " has not one coordinate for each point");
    if (!Integers(attachment, "physics:indices1").empty())
      Fault(attachment.path + ".indices1 is not empty");
  }

  void Frame(const UsdPrim& frame) {
    const UsdProperty* transform = frame.Find("xformOp:transform");
    const UsdProperty* order = frame.Find("xformOpOrder");
    if ((transform == nullptr) != (order == nullptr))
      return Fault(frame.path + " has an operation without order, or an order without operation");
    if (transform == nullptr) return;
    if (order->value.Texts() != std::vector<std::string>{"xformOp:transform"})
      Fault(frame.path + ".xformOpOrder is not that of its operations");
    const bool is_sampled = transform->value.kind == Kind::kSamples;
    for (const UsdValue& item :
         is_sampled ? transform->value.items : std::vector<UsdValue>{transform->value}) {
      const std::vector<double> numbers = item.Numbers();
      const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
      const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
      if ((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-9 ||
          turn.determinant() < 0 || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        Fault(frame.path + " does not move rigidly");
    }
  }

  UsdLayer layer_;
  std::vector<std::string> faults_;
  double start_ = 0, end_ = 0;
};

}  // namespace

std::vector<std::string> UsdFaults(const std::string& text) {
  try {
    return UsdCheck(ReadUsd(text)).Faults();
  } catch (const std::runtime_error& error) {
    return {error.what()};
  }
}

}  // namespace lacuna
