#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

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
          "TetrahedronHyperelasticityFEMForceField, NeoHookean with mu and K = lambda + 2 mu/3: "
          "agrees to first order in the strain"};
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
          lame.mu, lame.lambda + 2 * lame.mu / 3);
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
  std::string movements;
  for (const Eigen::Matrix3Xd& at : grip.displacements)
    fmt::format_to(std::back_inserter(movements), "[{}, {}, {}], ", at(0, 0), at(1, 0), at(2, 0));
  return fmt::format(
      "    body.addObject('LinearMovementProjectiveConstraint', indices=[{}],\n"
      "                   keyTimes=[{}],\n                   movements=[{}])\n",
      fmt::join(grip.part.nodes, ", "), fmt::join(model.times, ", "), movements);
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
      parts.push_back({part, How::kExact, "LinearMovementProjectiveConstraint"});
    else
      parts.push_back({part, How::kNone, "a motion that is not a translation"});
  }
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, IsConstant(load) ? How::kExact : How::kNone,
                     IsConstant(load) ? "ConstantForceField" : "a force that changes in time"});
  AddLostStart(model, &parts);
  return parts;
}

std::string SofaText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  const RayleighDamping damping = model.Damping();
  const Eigen::Vector3d gravity = model.Gravity();
  std::string text = FileComment(given, SofaCounterparts(given), "# ");
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
