#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "exchange/scene_writers.h"
#include "fem/lame_constants.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;

Counterpart EffectCounterpart(const PortableEffect& effect, const PortableModel& model) {
  const std::string law =
      "elasticity of a flexcomp, St. Venant-Kirchhoff, with the E and nu of mu and lambda/2, since "
      "MuJoCo counts lambda twice: ";
  switch (effect.kind) {
    case Kind::kSaintVenantKirchhoff:
      return {effect.name, How::kConverted, law + "the same law"};
    case Kind::kLinear:
      return {effect.name, How::kConverted, law + "agrees for small strains and rotations"};
    case Kind::kCorotational:
    case Kind::kNeoHookean:
      return {effect.name, How::kConverted, law + "agrees to first order in the strain"};
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

// A step at which MuJoCo, whose integrators take the elasticity of a flexcomp explicitly, is stable
// near the rest shape:
//   Δt = 2/ω / (√(1 + ζ²) + ζ), ζ = β ω/2, with ω² = (λ + 2μ) max_i Σ_e A_ei A_e / (9 V_e m).
// By Gershgorin's theorem ω² bounds the eigenvalues of M⁻¹ K, with some margin: element e has the
// volume V_e, the surface A_e and the face A_ei opposite to its node i, and every node has the mass
// m.
double StableStep(const PortableModel& model) {
  constexpr int kOpposite[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  const Eigen::Matrix3Xd& nodes = model.mesh.nodes;
  const Eigen::VectorXd volumes = TetVolumes(model.mesh);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(model.mesh.NodeCount());
  for (Eigen::Index e = 0; e < model.mesh.TetCount(); ++e) {
    const auto tet = model.mesh.tets.col(e);
    Eigen::Vector4d areas;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d corner = nodes.col(tet[kOpposite[k][0]]);
      areas[k] = (nodes.col(tet[kOpposite[k][1]]) - corner)
                     .cross(nodes.col(tet[kOpposite[k][2]]) - corner)
                     .norm() /
                 2;
    }
    for (int k = 0; k < 4; ++k) sums[tet[k]] += areas[k] * areas.sum() / (9 * volumes[e]);
  }
  const PortableEffect& law = model.Elasticity();
  const LameConstants lame = LameFromYoung(law.values[0], law.values[1]);
  const double mass = model.node_mass.sum() / static_cast<double>(model.mesh.NodeCount());
  const double frequency = std::sqrt((lame.lambda + 2 * lame.mu) * sums.maxCoeff() / mass);
  const double ratio = model.Damping().beta * frequency / 2;
  return 2 / frequency / (std::sqrt(1 + ratio * ratio) + ratio);
}

struct YoungPoisson {
  double young_modulus, poisson_ratio;
};

// The constants with which MuJoCo has the given law. Its energy of an element with the volume V is
// V (μ tr E² + λ (tr E)²) (MetricTensor in user_mesh.cc with mj_flexPassiveStretch in
// engine_passive.c, version 3.3 and later), so that λ/2 is to be given for λ.
YoungPoisson MujocoConstants(const PortableEffect& law) {
  LameConstants lame = LameFromYoung(law.values[0], law.values[1]);
  lame.lambda /= 2;
  const double poisson_ratio = lame.lambda / (2 * (lame.lambda + lame.mu));
  return {2 * lame.mu * (1 + poisson_ratio), poisson_ratio};
}

bool IsPin(const PortableGrip& grip) { return grip.displacements.empty() && grip.axes.IsAll(); }

}  // namespace

Counterparts MujocoCounterparts(const PortableModel& model) {
  Counterparts parts;
  AddLostMidpoints(model, &parts);
  for (const PortableEffect& effect : model.effects)
    parts.push_back(EffectCounterpart(effect, model));
  parts.push_back({"masses", How::kConverted, "every node gets the same share of the mass"});
  parts.push_back({"time step", How::kConverted,
                   "as short as MuJoCo needs, which takes the elasticity explicitly"});
  if (!model.is_static)
    parts.push_back({"inertia", How::kConverted,
                     "integrator implicitfast, of first order in the time step, in place of "
                     "Lacuna's time scheme"});
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, IsPin(grip) ? How::kExact : How::kNone,
                     IsPin(grip)                  ? "pin"
                     : grip.displacements.empty() ? "a pin holds along all axes"
                                                  : "it moves, and a pin does not"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kNone, "no element describes it"});
  AddLostStart(model, &parts);
  return parts;
}

std::string MujocoText(const PortableModel& given) {
  const PortableModel model = WithLinearElements(given);
  const PortableEffect& law = model.Elasticity();
  if (!law.IsElasticity())
    throw InputError(law.name + ": this elasticity law cannot be written into a MuJoCo model");
  if (law.values[1] < 0) throw InputError("MuJoCo has no negative Poisson's ratio");
  const YoungPoisson constants = MujocoConstants(law);
  const Eigen::Vector3d gravity = model.Gravity();
  std::string pins;
  for (const PortableGrip& grip : model.grips)
    if (IsPin(grip))
      pins += fmt::format("      <!-- {} -->\n      <pin id=\"{}\"/>\n",
                          XmlCommentText(grip.part.name), fmt::join(grip.part.nodes, " "));
  return fmt::format(
      "{}<mujoco model=\"lacuna\">\n"
      "  <option timestep=\"{}\" gravity=\"{} {} {}\" integrator=\"implicitfast\"/>\n"
      "  <worldbody>\n"
      "    <flexcomp name=\"body\" type=\"gmsh\" file=\"model.msh\" dim=\"3\" mass=\"{}\" "
      "radius=\"0.0001\">\n"
      "      <contact contype=\"0\" conaffinity=\"0\" selfcollide=\"none\" internal=\"false\"/>\n"
      "      <elasticity young=\"{}\" poisson=\"{}\" damping=\"{}\"/>\n{}"
      "    </flexcomp>\n  </worldbody>\n</mujoco>\n",
      XmlComment(given, MujocoCounterparts(given)), std::min(model.time_step, StableStep(model)),
      gravity.x(), gravity.y(), gravity.z(), model.node_mass.sum(), constants.young_modulus,
      constants.poisson_ratio, model.Damping().beta, pins);
}

}  // namespace lacuna
