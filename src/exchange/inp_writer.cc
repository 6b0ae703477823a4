#include "exchange/inp_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <iterator>
#include <map>
#include <utility>

#include "core/error.h"
#include "exchange/unique_names.h"

namespace lacuna {
namespace {

constexpr const char* kAxes = "XYZ";

// The shortest decimal number without exponent that is read back as the same double.
std::string Fixed(double value) {
  std::array<char, 1200> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed);
  std::string text(digits.data(), end.ptr);
  return text.find('.') == std::string::npos ? text + "." : text;
}

void AppendMesh(const TetMesh& mesh, std::string* text) {
  const auto end = std::back_inserter(*text);
  *text += "*NODE, NSET=ALL_NODES\n";
  for (Eigen::Index n = 0; n < mesh.NodeCount(); ++n)
    fmt::format_to(end, "{}, {}, {}, {}\n", n + 1, Fixed(mesh.nodes(0, n)), Fixed(mesh.nodes(1, n)),
                   Fixed(mesh.nodes(2, n)));
  fmt::format_to(end, "*ELEMENT, TYPE={}, ELSET=BODY\n", mesh.Order() == 2 ? "C3D10" : "C3D4");
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    fmt::format_to(end, "{}", e + 1);
    for (const int node : mesh.tets.col(e)) fmt::format_to(end, ", {}", node + 1);
    *text += "\n";
  }
}

// The lumped mass of each node as an element of its own.
void AppendPointMasses(const PortableModel& model, std::string* text) {
  const auto end = std::back_inserter(*text);
  for (Eigen::Index n = 0; n < model.node_mass.size(); ++n)
    fmt::format_to(end,
                   "*ELEMENT, TYPE=MASS, ELSET=MASS_{0}\n{1}, {0}\n*MASS, ELSET=MASS_{0}\n{2}\n",
                   n + 1, model.mesh.TetCount() + n + 1, InpNumber(model.node_mass[n]));
}

void AppendSet(const std::string& name, const std::vector<int>& nodes, std::string* text) {
  constexpr size_t kPerLine = 12;
  fmt::format_to(std::back_inserter(*text), "*NSET, NSET={}\n", name);
  for (size_t k = 0; k < nodes.size(); ++k)
    fmt::format_to(std::back_inserter(*text), "{}{}", nodes[k] + 1,
                   k + 1 == nodes.size() || k % kPerLine == kPerLine - 1 ? "\n" : ", ");
}

// A table over the total time: from 0 to its first value in the first step, then `values`.
void AppendAmplitude(const std::string& name, const std::vector<double>& times,
                     const Eigen::VectorXd& values, std::string* text) {
  constexpr size_t kPerLine = 4;
  fmt::format_to(std::back_inserter(*text), "*AMPLITUDE, NAME={}, TIME=TOTAL TIME\n0., 0.", name);
  for (size_t k = 0; k < times.size(); ++k)
    fmt::format_to(std::back_inserter(*text), "{}{}, {}", (k + 1) % kPerLine == 0 ? "\n" : ", ",
                   InpNumber(kInpRampTime + times[k]),
                   InpNumber(values[static_cast<Eigen::Index>(k)]));
  *text += "\n";
}

// What stands before the steps, and in each of them.
struct Sections {
  std::string amplitudes, fixed, moved, start_loads, constant_loads, loads;
};

void AddGrip(const PortableGrip& grip, const std::string& set, const PortableModel& model,
             Sections* sections) {
  if (grip.displacements.empty()) {
    if (grip.axes.IsAll()) {
      sections->fixed += fmt::format("{}, 1, 3\n", set);
      return;
    }
    for (int axis = 0; axis < 3; ++axis)
      if (grip.axes.Has(axis)) sections->fixed += fmt::format("{0}, {1}, {1}\n", set, axis + 1);
    return;
  }
  const bool is_translation = grip.IsTranslation();
  const size_t columns = is_translation ? 1 : grip.part.nodes.size();
  for (size_t column = 0; column < columns; ++column)
    for (int axis = 0; axis < 3; ++axis) {
      if (!grip.axes.Has(axis)) continue;
      const Eigen::VectorXd values = grip.Series(axis, static_cast<Eigen::Index>(column));
      const std::string place = is_translation ? set : std::to_string(grip.part.nodes[column] + 1);
      if (values.isZero(0)) {
        sections->fixed += fmt::format("{0}, {1}, {1}\n", place, axis + 1);
        continue;
      }
      const std::string name = fmt::format("U_{}_{}", place, kAxes[axis]);
      AppendAmplitude(name, model.times, values, &sections->amplitudes);
      sections->moved +=
          fmt::format("*BOUNDARY, AMPLITUDE={0}\n{1}, {2}, {2}, 1.\n", name, place, axis + 1);
    }
}

// All loads at one component of a node: CalculiX does not accept two amplitudes there.
struct NodalLoad {
  std::vector<std::pair<size_t, double>> shares;  // of which loads
  double constant = 0;                            // N, beside these loads
  double start = 0;                               // N, at the start, with the hold
};

// `weights` are forces on the nodes at all times, 3 × n, N, or empty.
void AddLoads(const PortableModel& model, const Eigen::Matrix3Xd& weights, Sections* sections) {
  std::map<std::pair<int, int>, NodalLoad> loads;  // by node and axis
  for (size_t l = 0; l < model.loads.size(); ++l)
    for (int axis = 0; axis < 3; ++axis) {
      const PortableLoad& load = model.loads[l];
      if (load.force.row(axis).isZero(0)) continue;
      for (size_t k = 0; k < load.part.nodes.size(); ++k) {
        NodalLoad& nodal = loads[{load.part.nodes[k], axis}];
        const double share = load.shares[static_cast<Eigen::Index>(k)];
        nodal.shares.emplace_back(l, share);
        nodal.start += share * load.force(axis, 0);
      }
    }
  for (Eigen::Index node = 0; node < weights.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis) {
      if (weights(axis, node) == 0) continue;
      NodalLoad& nodal = loads[{static_cast<int>(node), axis}];
      nodal.constant = weights(axis, node);
      nodal.start += weights(axis, node);
    }
  for (Eigen::Index node = 0; node < model.held_force.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (model.held_force(axis, node) != 0)
        loads[{static_cast<int>(node), axis}].start += model.held_force(axis, node);

  std::map<std::string, std::string> lines;  // by amplitude
  for (const auto& [place, nodal] : loads) {
    const auto [node, axis] = place;
    sections->start_loads +=
        fmt::format("{}, {}, {}\n", node + 1, axis + 1, InpNumber(nodal.start));
    if (nodal.shares.empty()) {
      if (nodal.constant != 0)
        sections->constant_loads +=
            fmt::format("{}, {}, {}\n", node + 1, axis + 1, InpNumber(nodal.constant));
      continue;
    }
    const bool is_single = nodal.shares.size() == 1 && nodal.constant == 0;
    const std::string name = is_single
                                 ? fmt::format("F_{}_{}", nodal.shares[0].first + 1, kAxes[axis])
                                 : fmt::format("F_NODE_{}_{}", node + 1, kAxes[axis]);
    const bool is_new = !lines.contains(name);
    lines[name] += fmt::format("{}, {}, {}\n", node + 1, axis + 1,
                               InpNumber(is_single ? nodal.shares[0].second : 1));
    if (!is_new) continue;
    Eigen::VectorXd values =
        Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model.times.size()), nodal.constant);
    for (const auto& [l, share] : nodal.shares)
      values += (is_single ? 1 : share) * model.loads[l].force.row(axis).transpose();
    AppendAmplitude(name, model.times, values, &sections->amplitudes);
  }
  for (const auto& [name, nodes] : lines)
    sections->loads += fmt::format("*CLOAD, AMPLITUDE={}\n{}", name, nodes);
}

std::string Output(bool is_first, InpDialect dialect) {
  const std::string at = is_first ? "" : ", TIME POINTS=FRAMES";
  if (dialect == InpDialect::kAbaqus) return "*OUTPUT, FIELD" + at + "\n*NODE OUTPUT\nU\n";
  // CalculiX computes the energies that *DYNAMIC needs only if the first step asks for them.
  return "*NODE PRINT, NSET=ALL_NODES" + (is_first ? ", FREQUENCY=1000000" : at) + "\nU\n" +
         "*NODE FILE" + (is_first ? ", FREQUENCY=1000000" : at) + "\nU\n" +
         (is_first ? "*EL PRINT, ELSET=BODY, TOTALS=ONLY\nELSE\n" : "");
}

std::string Steps(const PortableModel& model, const Sections& sections, InpDialect dialect) {
  const bool is_abaqus = dialect == InpDialect::kAbaqus;
  const bool has_branches =
      is_abaqus && model.Find(PortableEffect::Kind::kViscoelasticBranch) != nullptr;
  const std::string step =
      IsGeometricallyNonlinear(model) ? "*STEP, NLGEOM, INC=1000000\n" : "*STEP, INC=1000000\n";
  std::string text = "** Equilibrium before the motion\n" + step;
  text += has_branches ? "*STATIC, LONG TERM\n" : "*STATIC\n";
  text += IsGeometricallyNonlinear(model) ? "0.25, 1., 1e-6, 0.5\n" : "1., 1.\n";
  text += sections.moved;
  for (const PortableEffect& effect : model.effects)
    if (dialect != InpDialect::kCalculixPointMasses &&
        effect.kind == PortableEffect::Kind::kGravity && effect.values.norm() > 0) {
      const Eigen::Vector3d direction = effect.values.normalized();
      text +=
          fmt::format("*DLOAD\nBODY, GRAV, {}, {}, {}, {}\n", InpNumber(effect.values.norm()),
                      InpNumber(direction.x()), InpNumber(direction.y()), InpNumber(direction.z()));
    }
  if (!sections.start_loads.empty()) text += "*CLOAD\n" + sections.start_loads;
  text += Output(true, dialect) + "*END STEP\n";
  if (model.frames.empty()) return text;

  text += "** The motion\n" + step;
  if (!model.is_static)
    text += "*DYNAMIC, ALPHA=0.\n";
  else
    text += has_branches ? "*VISCO\n" : "*STATIC\n";
  text += fmt::format(
      "{0}, {1}, {2}, {3}\n", InpNumber(std::min(model.time_step, model.Duration())),
      InpNumber(model.Duration()), InpNumber(1e-4 * model.time_step), InpNumber(model.time_step));
  if (!sections.start_loads.empty())
    text += "*CLOAD, OP=NEW\n" + sections.constant_loads + sections.loads;
  return text + Output(false, dialect) + "*END STEP\n";
}

void AppendFrames(const PortableModel& model, std::string* text) {
  if (model.frames.empty()) return;
  *text += "*TIME POINTS, NAME=FRAMES\n";
  for (const double frame : model.frames) *text += InpNumber(frame) + "\n";
}

}  // namespace

std::vector<std::string> InpSetNames(const std::vector<NamedNodes>& parts) {
  UniqueNames taken({"ALL_NODES", "BODY"});
  std::vector<std::string> names;
  for (const NamedNodes& part : parts) {
    std::string name = Identifier(part.name);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char letter) { return std::toupper(letter); });
    names.push_back(taken.Add(name));
  }
  return names;
}

std::string InpText(const PortableModel& model, InpDialect dialect) {
  if (!model.Elasticity().IsElasticity())
    throw InputError(fmt::format("{}: this elasticity law cannot be written into an .inp file",
                                 model.Elasticity().name));
  const std::vector<std::string> sets = InpSetNames(model.regions);
  std::string text = fmt::format("*HEADING\nlacuna {}\n", CommentText(model.run.substr(0, 60)));
  text += FileComment(model, InpCounterparts(model, dialect), "** ");
  AppendMesh(model.mesh, &text);
  const bool has_point_masses = dialect == InpDialect::kCalculixPointMasses;
  if (has_point_masses) AppendPointMasses(model, &text);
  Sections sections;
  for (size_t k = 0; k < model.regions.size(); ++k) {
    if (sets[k] != model.regions[k].name)
      text += fmt::format("** \"{}\" in the recording\n", CommentText(model.regions[k].name));
    AppendSet(sets[k], model.regions[k].nodes, &text);
  }
  for (size_t g = 0; g < model.grips.size(); ++g)
    AddGrip(model.grips[g], sets[g], model, &sections);
  Eigen::Matrix3Xd weights(3, 0);
  if (has_point_masses) weights = model.Gravity() * model.node_mass.transpose();
  AddLoads(model, weights, &sections);
  text += InpMaterial(model, dialect) + "*SOLID SECTION, ELSET=BODY, MATERIAL=LACUNA\n";
  text += sections.amplitudes;
  AppendFrames(model, &text);
  if (!sections.fixed.empty()) text += "*BOUNDARY\n" + sections.fixed;
  return text + Steps(model, sections, dialect);
}

}  // namespace lacuna
