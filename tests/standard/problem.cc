#include "standard/problem.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/config.h"
#include "core/quantity.h"
#include "scan/region.h"
#include "standard/published_table.h"

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

// `value: 3 mm`, or `published: {row: 4, column: z_mm, minus: z0_mm, scale: 1 mm}`: an entry of the
// table, less another one of its row, times the scale. NaN without the table.
double ReadPublished(const Config& config, const Dimension& dimension,
                     const std::optional<PublishedTable>& table) {
  if (!config.Has("published")) return config.Quantity("value", dimension, kAnyValue);
  const Config entry = config.Child("published");
  const int row = entry.Integer("row", 1, 1000000);
  const std::string column = entry.Text("column"), minus = entry.Text("minus", "");
  const double scale = entry.Quantity("scale", dimension, kPositive);
  if (!table) return std::numeric_limits<double>::quiet_NaN();
  const double value = table->Number(row, column) - (minus.empty() ? 0 : table->Number(row, minus));
  return scale * value;
}

// Reads the unit in which the values are shown, by default the SI unit.
void ReadUnit(const Config& config, const Dimension& dimension, Wanted* wanted) {
  wanted->unit = config.Text("shown_in", dimension.unit);
  if (wanted->unit.empty()) return;
  try {
    wanted->scale = ParseQuantity("1 " + wanted->unit, dimension);
  } catch (const std::invalid_argument& problem) {
    config.Fail("shown_in", problem.what());
  }
}

Wanted ReadWanted(const Config& config, const std::optional<PublishedTable>& table) {
  Wanted wanted;
  ReadQuantity(config, &wanted);
  if (wanted.kind == Kind::kDisplacement || wanted.kind == Kind::kStress ||
      wanted.kind == Kind::kVonMises)
    wanted.point = ReadBlockPart(config.Child("at"));
  if (wanted.kind == Kind::kReaction || wanted.kind == Kind::kTorque)
    wanted.support = config.Text("of");
  if (wanted.kind == Kind::kFrequency) wanted.mode = config.Integer("mode", 1, 100);
  const Dimension dimension = DimensionOf(wanted.kind);
  wanted.label = config.Text("label", "");
  wanted.time = config.Quantity("time", kTime, kNotNegative, 0);
  wanted.value = ReadPublished(config, dimension, table);
  ReadUnit(config, dimension, &wanted);
  return wanted;
}

// The value of a wanted `time` is that after a step which ends there, on every mesh.
void RequireStepsAtWantedTimes(const Problem& problem, const Config& config) {
  for (const Wanted& wanted : problem.wanted) {
    if (wanted.time == 0) continue;
    if (problem.duration == 0) config.Fail("wanted", "`time` needs a motion");
    for (const ProblemMesh& mesh : problem.meshes) {
      const double steps = wanted.time / problem.duration * mesh.steps;
      if (steps > mesh.steps || std::abs(steps - std::round(steps)) > 1e-6)
        config.Fail("wanted",
                    fmt::format("no step ends at {:g} s with {} steps", wanted.time, mesh.steps));
    }
  }
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

ProblemLoad ReadLoad(const Config& config) {
  ProblemLoad load;
  load.part = ReadBlockPart(config.Child("where"));
  load.traction = config.Vector("traction", kPressure, load.traction);
  load.line_force = config.Vector("line_force", kForce, load.line_force);
  if (load.traction.isZero(0) == load.line_force.isZero(0))
    config.Fail("", "expected a traction or a line_force");
  load.profile = ReadProfile(config);
  return load;
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
  for (const Config& item : config.Items("loads")) problem.loads.push_back(ReadLoad(item));
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
  std::optional<PublishedTable> table;
  if (config.Has("data")) {
    const std::filesystem::path data = config.Path("data");
    if (std::filesystem::exists(data))
      table = PublishedTable::Load(data);
    else
      problem.missing_data = data;
  }
  for (const Config& item : config.Items("wanted"))
    problem.wanted.push_back(ReadWanted(item, table));
  if (problem.wanted.empty()) config.Fail("wanted", "names no quantity");
  for (const Wanted& wanted : problem.wanted)
    if (std::isnan(wanted.value) && problem.missing_data.empty())
      config.Fail("wanted", "a published entry needs the table `data`");
  for (const Config& item : config.Items("peers"))
    problem.peers.push_back(ReadPeer(item, problem.wanted));
  for (const Config& item : config.Items("meshes")) problem.meshes.push_back(ReadMesh(item));
  RequireStepsAtWantedTimes(problem, config);
  problem.orders = config.Integers("orders", 1);
  problem.tolerances = config.Quantities("tolerances", kDimensionless, kPositive);
  if (problem.tolerances.size() != problem.orders.size())
    config.Fail("tolerances", "expected one for each of the orders");
  problem.quick = config.Integer("quick", 1, static_cast<int>(problem.meshes.size()));
  config.RefuseUnknownKeys();
  return problem;
}

}  // namespace lacuna
