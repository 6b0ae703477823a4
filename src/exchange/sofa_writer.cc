#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "core/error.h"
#include "exchange/scene_writers.h"
#include "fem/lame_constants.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;

// Up to rounding: the sum over the nodes may depend on the alignment of the numbers.
bool IsConstant(const PortableLoad& load) {
  const double size = load.force.cwiseAbs().maxCoeff();
  return (load.force.colwise() - Eigen::Vector3d(load.force.col(0))).cwiseAbs().maxCoeff() <=
         1e-12 * size;
}

Counterpart EffectCounterpart(const PortableEffect& effect, const PortableModel& model) {
  switch (effect.kind) {
    case Kind::kLinear:
      return {effect.name, How::kExact, "TetrahedronFEMForceField, method small"};
    case Kind::kCorotational:
      return {effect.name, How::kConverted,
              "TetrahedronFEMForceField, method polar: the same law without the derivative of the "
              "rotation in the forces"};
    case Kind::kSaintVenantKirchhoff:
      return {effect.name, How::kExact,
              "TetrahedronHyperelasticityFEMForceField, StVenantKirchhoff with mu, lambda"};
    case Kind::kNeoHookean:
      return {
          effect.name, How::kConverted,
          "TetrahedronHyperelasticityFEMForceField, NeoHookean with mu, lambda: mu/2 (F:F-3) - mu "
          "ln J + lambda/2 (ln J)^2 in place of mu/2 (F:F-3) - mu (J-1) + (lambda+mu)/2 (J-1)^2; "
          "agrees to second order in J-1"};
    case Kind::kGravity:
      return {effect.name, How::kExact, "gravity of the root node"};
    case Kind::kMassDamping:
      return {effect.name, How::kExact, "rayleighMass"};
    case Kind::kStiffnessDamping:
      if (!model.IsProportional(effect))
        return {effect.name, How::kNone, "its Poisson's ratio is not that of the material"};
      return {effect.name, How::kConverted,
              "rayleighStiffness = beta E_damping/E, times the tangent stiffness"};
    default:
      return {effect.name, How::kNone, "no component that is written describes it"};
  }
}

std::string ForceField(const PortableEffect& law) {
  const LameConstants lame = LameFromYoung(law.values[0], law.values[1]);
  switch (law.kind) {
    case Kind::kSaintVenantKirchhoff:
      return fmt::format(
          "'TetrahedronHyperelasticityFEMForceField', materialName='StVenantKirchhoff', "
          "ParameterSet=[{}, {}]",
          lame.mu, lame.lambda);
    case Kind::kNeoHookean:
      return fmt::format(
          "'TetrahedronHyperelasticityFEMForceField', materialName='NeoHookean', "
          "ParameterSet=[{}, {}]",
          lame.mu, lame.lambda);
    case Kind::kLinear:
    case Kind::kCorotational:
      return fmt::format(
          "'TetrahedronFEMForceField', method='{}', youngModulus={}, poissonRatio={}",
          law.kind == Kind::kLinear ? "small" : "polar", law.values[0], law.values[1]);
    default:
      throw InputError(law.name + ": this elasticity law cannot be written into a SOFA scene");
  }
}

bool IsWritten(const PortableGrip& grip) {
  return grip.displacements.empty() || (grip.IsTranslation() && grip.axes.IsAll());
}

// The indices that follow are those of this part.
std::string PartComment(const NamedNodes& part) {
  return fmt::format("    # {}\n", CommentText(part.name));
}

std::string GripText(const PortableGrip& grip, const PortableModel& model) {
  if (grip.displacements.empty() && !grip.axes.IsAll())
    return fmt::format(
        "    body.addObject('PartialFixedProjectiveConstraint', indices=[{}],\n"
        "                   fixedDirections=[{}, {}, {}])\n",
        fmt::join(grip.part.nodes, ", "), grip.axes.Has(0) ? 1 : 0, grip.axes.Has(1) ? 1 : 0,
        grip.axes.Has(2) ? 1 : 0);
  if (grip.displacements.empty())
    return fmt::format("    body.addObject('FixedProjectiveConstraint', indices=[{}])\n",
                       fmt::join(grip.part.nodes, ", "));
  // The constraint lets its nodes go at its last key time. The last movement is therefore repeated
  // at a time that no simulation reaches.
  constexpr double kNever = 1e9;  // s
  std::vector<double> times = model.times;
  times.push_back(kNever);
  std::string movements;
  for (size_t k = 0; k < times.size(); ++k) {
    const Eigen::Vector3d at = grip.displacements[std::min(k, model.times.size() - 1)].col(0);
    fmt::format_to(std::back_inserter(movements), "[{}, {}, {}], ", at.x(), at.y(), at.z());
  }
  return fmt::format(
      "    body.addObject('LinearMovementProjectiveConstraint', indices=[{}],\n"
      "                   keyTimes=[{}],\n                   movements=[{}])\n",
      fmt::join(grip.part.nodes, ", "), fmt::join(times, ", "), movements);
}

std::string LoadText(const PortableLoad& load) {
  std::string forces;
  for (const double share : load.shares)
    fmt::format_to(std::back_inserter(forces), "[{}, {}, {}], ", share * load.force(0, 0),
                   share * load.force(1, 0), share * load.force(2, 0));
  return fmt::format("    body.addObject('ConstantForceField', indices=[{}], forces=[{}])\n",
                     fmt::join(load.part.nodes, ", "), forces);
}

}  // namespace

Counterparts SofaCounterparts(const PortableModel& model) {
  Counterparts parts;
  AddLostMidpoints(model, &parts);
  for (const PortableEffect& effect : model.effects)
    parts.push_back(EffectCounterpart(effect, model));
  for (const PortableGrip& grip : model.grips) {
    const std::string part = "grip " + grip.part.name;
    if (grip.displacements.empty())
      parts.push_back(
          {part, How::kExact,
           grip.axes.IsAll() ? "FixedProjectiveConstraint" : "PartialFixedProjectiveConstraint"});
    else if (!grip.axes.IsAll())
      parts.push_back({part, How::kNone, "a motion along some axes only"});
    else if (grip.IsTranslation())
      parts.push_back({part, How::kExact,
                       "LinearMovementProjectiveConstraint, linear between times at most one time "
                       "step apart; at rest after the last one"});
    else
      parts.push_back({part, How::kNone, "a motion that is not a translation"});
  }
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, IsConstant(load) ? How::kExact : How::kNone,
                     IsConstant(load) ? "ConstantForceField" : "a force that changes in time"});
  if (!model.is_static)
    parts.push_back({"inertia", How::kConverted,
                     "lumped masses; EulerImplicitSolver, the linearised backward Euler method, of "
                     "first order and with numerical damping, in place of Lacuna's time scheme"});
  AddLostStart(model, &parts);
  return parts;
}

std::string SofaText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  const RayleighDamping damping = model.Damping();
  const Eigen::Vector3d gravity = model.Gravity();
  std::string text = FileComment(given, SofaCounterparts(given), "# ");
  text += "# For SOFA 24.06 and later\n";
  // The option trapezoidalScheme is no improvement: the positions still advance by the step times
  // the new velocity, which is of first order, and since SOFA 25.06 an undamped vibration grows
  // where a step is longer than 2/ω.
  text += fmt::format(
      "import os\n\n\ndef createScene(root):\n"
      "    root.gravity = [{}, {}, {}]\n    root.dt = {}\n"
      "    root.addObject('RequiredPlugin', pluginName=['Sofa.Component'])\n"
      "    root.addObject('DefaultAnimationLoop')\n"
      "    body = root.addChild('body')\n"
      "    body.addObject('EulerImplicitSolver', rayleighMass={}, rayleighStiffness={})\n"
      "    body.addObject('SparseLDLSolver', template='CompressedRowSparseMatrixMat3x3d')\n"
      "    mesh = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'model.msh')\n"
      "    body.addObject('MeshGmshLoader', name='loader', filename=mesh)\n"
      "    body.addObject('TetrahedronSetTopologyContainer', src='@loader')\n"
      "    body.addObject('TetrahedronSetGeometryAlgorithms', template='Vec3d')\n"
      "    body.addObject('MechanicalObject', template='Vec3d', src='@loader')\n"
      "    body.addObject('MeshMatrixMass', massDensity={}, lumping=True)\n"
      "    body.addObject({})\n",
      gravity.x(), gravity.y(), gravity.z(), model.time_step, damping.alpha, damping.beta,
      model.density, ForceField(model.Elasticity()));
  for (const PortableGrip& grip : model.grips)
    if (IsWritten(grip)) text += PartComment(grip.part) + GripText(grip, model);
  for (const PortableLoad& load : model.loads)
    if (IsConstant(load)) text += PartComment(load.part) + LoadText(load);
  return text;
}

}  // namespace lacuna
