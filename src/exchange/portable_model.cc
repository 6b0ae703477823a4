#include "exchange/portable_model.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "effects/standard_cards.h"
#include "effects/uniform_density.h"
#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;

Kind KindOf(const EffectCard& card) {
  const std::pair<const EffectCard*, Kind> kinds[] = {
      {&LinearElasticityCard(), Kind::kLinear},
      {&CorotationalElasticityCard(), Kind::kCorotational},
      {&SaintVenantKirchhoffCard(), Kind::kSaintVenantKirchhoff},
      {&NeoHookeanCard(), Kind::kNeoHookean},
      {&GravityCard(), Kind::kGravity},
      {&MassDampingCard(), Kind::kMassDamping},
      {&StiffnessDampingCard(), Kind::kStiffnessDamping},
      {&ViscoelasticBranchCard(), Kind::kViscoelasticBranch}};
  for (const auto& [known, kind] : kinds)
    if (known == &card) return kind;
  return Kind::kOther;
}

PortableEffect DescribeEffect(const Effect& effect) {
  const EffectCard& card = effect.Card();
  PortableEffect described{KindOf(card), card.type, effect.Parameters(), {}, {}};
  for (const ParameterCard& parameter : card.parameters)
    described.value_names.push_back(parameter.name);
  const CatalogueEntry* entry = FindEntry(card.type);
  if (entry != nullptr && entry->format != nullptr) described.yaml = entry->format(effect);
  return described;
}

// 0 at the start of the motion, then steps of at most `time_step` that meet every frame.
std::vector<double> SampleTimes(const std::vector<double>& frames, double time_step) {
  std::vector<double> times{0};
  for (const double frame : frames) {
    const double begin = times.back();
    if (frame <= begin) continue;
    const int steps = std::max(1, static_cast<int>(std::ceil((frame - begin) / time_step - 1e-9)));
    for (int k = 1; k < steps; ++k) times.push_back(begin + (frame - begin) * k / steps);
    times.push_back(frame);
  }
  return times;
}

std::vector<int> Ascending(const Eigen::VectorXi& nodes) {
  std::vector<int> sorted(nodes.begin(), nodes.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

PortableGrip DescribeGrip(const Grip& grip, const std::string& name, const TetMesh& mesh,
                          const PortableModel& model) {
  PortableGrip described{{name, Ascending(grip.nodes)}, {}, grip.axes};
  if (!grip.motion) return described;
  std::vector<int> order(static_cast<size_t>(grip.nodes.size()));
  for (size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return grip.nodes[a] < grip.nodes[b]; });
  for (const double time : model.times) {
    const Eigen::Matrix3Xd places = grip.motion(model.start + time);
    described.displacements.emplace_back(places(Eigen::all, order) -
                                         mesh.nodes(Eigen::all, described.part.nodes));
  }
  return described;
}

// The nodal forces of a load at a time of the motion, 3 × n.
Eigen::Matrix3Xd NodalForce(const Effect& load, const Body& body, double time) {
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(rest.size());
  Eigen::VectorXd force = zero;
  load.AddForce({body, rest, zero, zero, time, 0, {}}, &force);
  return force.reshaped(3, body.NodeCount());
}

PortableLoad DescribeLoad(const Effect& load, const std::string& name, const Body& body,
                          const PortableModel& model) {
  PortableLoad described{{name, {}}, {}, Eigen::Matrix3Xd(3, model.times.size())};
  Eigen::Matrix3Xd largest = Eigen::Matrix3Xd::Zero(3, body.NodeCount());
  for (size_t k = 0; k < model.times.size(); ++k) {
    const Eigen::Matrix3Xd nodal = NodalForce(load, body, model.start + model.times[k]);
    described.force.col(static_cast<Eigen::Index>(k)) = nodal.rowwise().sum();
    if (nodal.rowwise().sum().norm() > largest.rowwise().sum().norm()) largest = nodal;
  }
  const Eigen::Vector3d total = largest.rowwise().sum();
  const double size = total.squaredNorm();
  std::vector<double> shares;
  for (int node = 0; node < body.NodeCount() && size > 0; ++node) {
    const double share = total.dot(largest.col(node)) / size;
    if (share == 0) continue;
    described.part.nodes.push_back(node);
    shares.push_back(share);
  }
  described.shares =
      Eigen::Map<const Eigen::VectorXd>(shares.data(), static_cast<Eigen::Index>(shares.size()));
  return described;
}

}  // namespace

bool PortableGrip::IsTranslation() const {
  double size = 0;
  for (const Eigen::Matrix3Xd& at : displacements) size = std::max(size, at.cwiseAbs().maxCoeff());
  return std::all_of(displacements.begin(), displacements.end(), [&](const Eigen::Matrix3Xd& at) {
    return (at.colwise() - at.col(0)).cwiseAbs().maxCoeff() <= 1e-9 * size;
  });
}

const PortableEffect* PortableModel::Find(PortableEffect::Kind kind) const {
  for (const PortableEffect& effect : effects)
    if (effect.kind == kind) return &effect;
  return nullptr;
}

Eigen::VectorXd PortableGrip::Series(Eigen::Index axis, Eigen::Index node) const {
  Eigen::VectorXd series(static_cast<Eigen::Index>(displacements.size()));
  for (Eigen::Index k = 0; k < series.size(); ++k)
    series[k] = displacements[static_cast<size_t>(k)](axis, node);
  return series;
}

bool PortableModel::IsProportional(const PortableEffect& effect) const {
  return std::abs(effect.values[2] - Elasticity().values[1]) <= 1e-9;
}

Eigen::Vector3d PortableModel::Gravity() const {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  for (const PortableEffect& effect : effects)
    if (effect.kind == Kind::kGravity) gravity += effect.values;
  return gravity;
}

RayleighDamping PortableModel::Damping() const {
  RayleighDamping damping;
  for (const PortableEffect& effect : effects) {
    if (effect.kind == Kind::kMassDamping) damping.alpha += effect.values[0];
    if (effect.kind == Kind::kStiffnessDamping && IsProportional(effect))
      damping.beta += effect.values[0] * effect.values[1] / Elasticity().values[0];
  }
  return damping;
}

PortableModel DescribeModel(const Model& model, const TetMesh& mesh,
                            const PredictionOptions& options, const std::vector<double>& frames,
                            const PortableNames& names) {
  CHECK_EQ(names.grips.size(), model.grips.size());
  const Body& body = *model.body;
  PortableModel described;
  described.mesh = mesh;
  described.density = DensityWith(model.effects, body.density);
  described.node_mass = body.node_mass * (described.density / body.density);
  described.start = options.start_time;
  described.time_step = options.time_step;
  described.is_static = options.step.scheme == TimeScheme::kQuasiStatic;
  for (const double frame : frames)
    if (frame > options.start_time) described.frames.push_back(frame - options.start_time);
  described.times = SampleTimes(described.frames, options.time_step);
  for (size_t g = 0; g < model.grips.size(); ++g)
    described.grips.push_back(DescribeGrip(model.grips[g], names.grips[g], mesh, described));
  for (const auto& effect : WithDensityInBody(model.effects, body.density)) {
    if (dynamic_cast<const PrescribedForce*>(effect.get()) == nullptr) {
      described.effects.push_back(DescribeEffect(*effect));
      continue;
    }
    CHECK_LT(described.loads.size(), names.loads.size());
    described.loads.push_back(
        DescribeLoad(*effect, names.loads[described.loads.size()], body, described));
  }
  if (options.held_force.size() > 0 && !options.held_force.isZero(0))
    described.held_force = options.held_force.reshaped(3, body.NodeCount());
  for (const PortableGrip& grip : described.grips) described.regions.push_back(grip.part);
  described.regions.insert(described.regions.end(), names.regions.begin(), names.regions.end());
  return described;
}

}  // namespace lacuna
