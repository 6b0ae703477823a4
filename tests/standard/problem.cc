#include "standard/problem.h"

#include <fmt/format.h>

#include "core/config.h"
#include "scan/region.h"

namespace lacuna {
namespace {

using Kind = Wanted::Kind;

ProblemSupport ReadSupport(const Config& config) {
  ProblemSupport support;
  support.name = config.Text("name", "");
  support.part = ReadBlockPart(config.Child("where"));
  support.axes = ReadDirections(config);
  if (const auto motion = config.OptionalChild("motion")) {
    support.translation = motion->Vector("translation", kLength, support.translation);
    support.centre = motion->Vector("centre", kLength, support.centre);
    support.angle = motion->Quantity("angle", kAngle, kAnyValue, 0);
    support.profile = ReadProfile(*motion);
  }
  return support;
}

// Quantities with a component: the name before it, and the names of the components.
struct Components {
  const char* name;
  Kind kind;
  std::vector<const char*> of;
};

void ReadQuantity(const Config& config, Wanted* wanted) {
  static const std::vector<Components> kQuantities = {
      {"displacement_", Kind::kDisplacement, {"x", "y", "z"}},
      {"stress_", Kind::kStress, {"xx", "yy", "zz", "yz", "xz", "xy"}},
      {"reaction_", Kind::kReaction, {"x", "y", "z"}},
      {"velocity_", Kind::kVelocity, {"x", "y", "z"}},
      {"von_mises", Kind::kVonMises, {""}},
      {"torque_z", Kind::kTorque, {""}},
      {"frequency", Kind::kFrequency, {""}},
      {"energy", Kind::kEnergy, {""}}};
  wanted->name = config.Text("quantity");
  for (const Components& quantity : kQuantities)
    for (size_t k = 0; k < quantity.of.size(); ++k)
      if (wanted->name == std::string(quantity.name) + quantity.of[k]) {
        wanted->kind = quantity.kind;
        wanted->component = static_cast<int>(k);
        return;
      }
  config.Fail("quantity", fmt::format("got \"{}\"", wanted->name));
}

Dimension DimensionOf(Kind kind) {
  switch (kind) {
    case Kind::kDisplacement:
      return kLength;
    case Kind::kStress:
    case Kind::kVonMises:
      return kPressure;
    case Kind::kReaction:
      return kForce;
    case Kind::kTorque:
      return {2, 1, -2, 0, 0, "a torque", "1 N m", "N m"};
    case Kind::kFrequency:
      return kRate;
    case Kind::kVelocity:
      return kVelocity;
    case Kind::kEnergy:
      return kDimensionless;
  }
  return kDimensionless;
}

Wanted ReadWanted(const Config& config) {
  Wanted wanted;
  ReadQuantity(config, &wanted);
  if (wanted.kind == Kind::kDisplacement || wanted.kind == Kind::kStress ||
      wanted.kind == Kind::kVonMises)
    wanted.point = ReadBlockPart(config.Child("at"));
  if (wanted.kind == Kind::kReaction || wanted.kind == Kind::kTorque)
    wanted.support = config.Text("of");
  if (wanted.kind == Kind::kFrequency) wanted.mode = config.Integer("mode", 1, 100);
  const Dimension dimension = DimensionOf(wanted.kind);
  wanted.value = config.Quantity("value", dimension, kAnyValue);
  wanted.unit = config.Text("shown_in", dimension.unit);
  return wanted;
}

PeerResult ReadPeer(const Config& config, const std::vector<Wanted>& wanted) {
  PeerResult peer;
  peer.program = config.Text("program");
  peer.wanted =
      static_cast<size_t>(config.Integer("wanted", 1, static_cast<int>(wanted.size()), 1) - 1);
  peer.value = config.Quantity("value", DimensionOf(wanted[peer.wanted].kind), kAnyValue);
  peer.source = config.Text("source");
  return peer;
}

ProblemMesh ReadMesh(const Config& config) {
  ProblemMesh mesh;
  const std::vector<int> cells = config.Integers("cells", 1);
  if (cells.size() != 3) config.Fail("cells", "expected three numbers of cells");
  mesh.cells = {cells[0], cells[1], cells[2]};
  mesh.steps = config.Integer("steps", 1, 10000000, 1);
  return mesh;
}

}  // namespace

Problem ReadProblem(const std::filesystem::path& file) {
  const Config config = Config::Load(file);
  config.Integer("schema_version", 1, 1);
  Problem problem;
  problem.name = config.Text("name");
  problem.title = config.Text("title");
  problem.source = config.Text("source");
  problem.remark = config.Text("remark", "");
  problem.map = ReadBlockMap(config.Child("body"));
  problem.effects = ReadEffects(config);
  problem.density = config.Quantity("density", kDensity, kPositive, 1000);
  for (const Config& item : config.Items("supports")) problem.supports.push_back(ReadSupport(item));
  for (const Config& item : config.Items("loads"))
    problem.loads.push_back({ReadBlockPart(item.Child("where")), item.Vector("traction", kPressure),
                             ReadProfile(item)});
  const Config solve = config.Child("solve");
  problem.kind = solve.Choice<ProblemKind>("kind", {{"static", ProblemKind::kStatic},
                                                    {"modes", ProblemKind::kModes},
                                                    {"quasi_static", ProblemKind::kQuasiStatic},
                                                    {"motion", ProblemKind::kMotion}});
  if (problem.kind == ProblemKind::kQuasiStatic || problem.kind == ProblemKind::kMotion)
    problem.duration = solve.Quantity("duration", kTime, kPositive);
  if (problem.kind == ProblemKind::kMotion) {
    problem.scheme = ReadTimeScheme(solve, "two_step");
    problem.velocity = solve.Vector("velocity", kVelocity, problem.velocity);
  }
  for (const Config& item : config.Items("wanted")) problem.wanted.push_back(ReadWanted(item));
  if (problem.wanted.empty()) config.Fail("wanted", "names no quantity");
  for (const Config& item : config.Items("peers"))
    problem.peers.push_back(ReadPeer(item, problem.wanted));
  for (const Config& item : config.Items("meshes")) problem.meshes.push_back(ReadMesh(item));
  problem.orders = config.Integers("orders", 1);
  problem.tolerances = config.Quantities("tolerances", kDimensionless, kPositive);
  if (problem.tolerances.size() != problem.orders.size())
    config.Fail("tolerances", "expected one for each of the orders");
  problem.quick = config.Integer("quick", 1, static_cast<int>(problem.meshes.size()));
  config.RefuseUnknownKeys();
  return problem;
}

}  // namespace lacuna
