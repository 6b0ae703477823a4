#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "core/error.h"
#include "exchange/scene_writers.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;

Counterpart EffectCounterpart(const PortableEffect& effect, const PortableModel& model) {
  switch (effect.kind) {
    case Kind::kSaintVenantKirchhoff:
      return {effect.name, How::kExact, "elasticity of a flexcomp"};
    case Kind::kLinear:
      return {effect.name, How::kConverted,
              "elasticity of a flexcomp, St. Venant-Kirchhoff: agrees for small strains and "
              "rotations"};
    case Kind::kCorotational:
    case Kind::kNeoHookean:
      return {
          effect.name, How::kConverted,
          "elasticity of a flexcomp, St. Venant-Kirchhoff: agrees to first order in the strain"};
    case Kind::kGravity:
      return {effect.name, How::kExact, "gravity of option"};
    case Kind::kStiffnessDamping:
      if (!model.IsProportional(effect))
        return {effect.name, How::kNone, "its Poisson's ratio is not that of the material"};
      return {effect.name, How::kConverted,
              "damping of elasticity = beta E_damping/E, times the stiffness"};
    default:
      return {effect.name, How::kNone, "no element that is written describes it"};
  }
}

bool IsPin(const PortableGrip& grip) { return grip.displacements.empty() && grip.axes.IsAll(); }

}  // namespace

Counterparts MujocoCounterparts(const PortableModel& model) {
  Counterparts parts;
  AddLostMidpoints(model, &parts);
  for (const PortableEffect& effect : model.effects)
    parts.push_back(EffectCounterpart(effect, model));
  parts.push_back({"masses", How::kConverted, "every node gets the same share of the mass"});
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, IsPin(grip) ? How::kExact : How::kNone,
                     IsPin(grip)                  ? "pin"
                     : grip.displacements.empty() ? "a pin holds along all axes"
                                                  : "it moves, and a pin does not"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kNone, "no element describes it"});
  parts.push_back({"equilibrium at the start", How::kNone,
                   "the scene begins with the rest shape, to which gravity is applied at once"});
  if (model.is_static)
    parts.push_back({"quasi-static motion", How::kNone, "the scene has inertia"});
  return parts;
}

std::string MujocoText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  const PortableEffect& law = model.Elasticity();
  if (!law.IsElasticity())
    throw InputError(law.name + ": this elasticity law cannot be written into a MuJoCo model");
  const Eigen::Vector3d gravity = model.Gravity();
  std::vector<int> pins;
  for (const PortableGrip& grip : model.grips)
    if (IsPin(grip)) pins.insert(pins.end(), grip.part.nodes.begin(), grip.part.nodes.end());
  return fmt::format(
      "{}<mujoco model=\"lacuna\">\n"
      "  <option timestep=\"{}\" gravity=\"{} {} {}\" integrator=\"implicitfast\"/>\n"
      "  <worldbody>\n"
      "    <flexcomp name=\"body\" type=\"gmsh\" file=\"model.msh\" dim=\"3\" mass=\"{}\" "
      "radius=\"0.0001\">\n"
      "      <contact contype=\"0\" conaffinity=\"0\" selfcollide=\"none\" internal=\"false\"/>\n"
      "      <elasticity young=\"{}\" poisson=\"{}\" damping=\"{}\"/>\n{}"
      "    </flexcomp>\n  </worldbody>\n</mujoco>\n",
      XmlComment(given, MujocoCounterparts(given)), model.time_step, gravity.x(), gravity.y(),
      gravity.z(), model.node_mass.sum(), law.values[0], law.values[1], model.Damping().beta,
      pins.empty() ? "" : fmt::format("      <pin id=\"{}\"/>\n", fmt::join(pins, " ")));
}

}  // namespace lacuna
