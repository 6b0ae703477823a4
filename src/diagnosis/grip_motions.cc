#include "diagnosis/grip_motions.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace lacuna {
namespace {

struct GripNodes {
  Eigen::VectorXi nodes;
  Eigen::Vector3d centre;
  Eigen::Vector3d held;  // 1 along the axes along which the grip holds its nodes, else 0
};

Eigen::VectorXd RigidMotion(const GripNodes& grip, const Eigen::Matrix3Xd& rest,
                            const Eigen::Vector3d& shift, const Eigen::Vector3d& rotation) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * rest.cols());
  for (const int node : grip.nodes)
    motion.segment<3>(3 * node) =
        grip.held.cwiseProduct(shift + rotation.cross(rest.col(node) - grip.centre));
  return motion;
}

MisfitDirection ConstantMotion(Eigen::VectorXd motion) {
  MisfitDirection direction;
  direction.perturbation.grip = [motion = std::move(motion)](double, const Eigen::VectorXd&) {
    return motion;
  };
  return direction;
}

// The grip yields to its force, or turns with its moment, whose largest norm is added to
// `largest`.
MisfitDirection YieldingMotion(const GripNodes& grip, const Eigen::Matrix3Xd& rest, bool turns,
                               std::shared_ptr<LargestNorm> largest) {
  MisfitDirection direction;
  direction.perturbation.grip = [grip, rest, turns, largest = std::move(largest)](
                                    double, const Eigen::VectorXd& reaction) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (const int node : grip.nodes) {
      const Eigen::Vector3d here = grip.held.cwiseProduct(reaction.segment<3>(3 * node));
      force += here;
      moment += (rest.col(node) - grip.centre).cross(here);
    }
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Eigen::VectorXd motion =
        turns ? RigidMotion(grip, rest, zero, -moment) : RigidMotion(grip, rest, -force, zero);
    largest->Add(turns ? moment.norm() : force.norm());
    return motion;
  };
  return direction;
}

MisfitDirection StrainMotion(const GripNodes& grip, const Eigen::Matrix3Xd& rest, int entry) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * rest.cols());
  for (const int node : grip.nodes)
    motion[3 * node + entry % 3] =
        grip.held[entry % 3] * (rest(entry / 3, node) - grip.centre[entry / 3]);
  return ConstantMotion(std::move(motion));
}

bool Deforms(const CalibrationProblem& problem, size_t grip) {
  return std::any_of(problem.models().begin(), problem.models().end(), [&](const auto& model) {
    const RecordedGrip* recorded = RecordedAs(model.item().recording, grip);
    return recorded != nullptr && recorded->deforms;
  });
}

}  // namespace

GripMotions MakeGripMotions(const CalibrationProblem& problem) {
  const Model& model = problem.models().front().model();
  const Eigen::Matrix3Xd& rest = model.body->mesh.nodes;
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  GripMotions motions;
  std::vector<MisfitDirection>& directions = motions.directions;
  const auto next = [&] { return static_cast<Eigen::Index>(directions.size()); };
  for (size_t g = 0; g < model.grips.size(); ++g) {
    GripNodes nodes{model.grips[g].nodes, zero, zero};
    for (int axis = 0; axis < 3; ++axis) nodes.held[axis] = model.grips[g].axes.Has(axis);
    if (nodes.nodes.size() == 0) continue;
    nodes.centre = rest(Eigen::all, nodes.nodes).rowwise().mean();
    GripMotions::Grip& grip = motions.grips.emplace_back();
    grip.grip = g;
    grip.label = model.grips.size() > 1 ? fmt::format("grip {}", g + 1) : "the grip";
    grip.force = std::make_shared<LargestNorm>();
    grip.moment = std::make_shared<LargestNorm>();
    grip.rigid = next();
    for (int axis = 0; axis < 6; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis % 3);
      directions.push_back(ConstantMotion(axis < 3 ? RigidMotion(nodes, rest, unit, zero)
                                                   : RigidMotion(nodes, rest, zero, unit)));
    }
    grip.yielding = next();
    directions.push_back(YieldingMotion(nodes, rest, /*turns=*/false, grip.force));
    directions.push_back(YieldingMotion(nodes, rest, /*turns=*/true, grip.moment));
    if (!Deforms(problem, g)) continue;
    grip.strain = next();
    for (int entry = 0; entry < 9; ++entry) directions.push_back(StrainMotion(nodes, rest, entry));
  }
  return motions;
}

const RecordedGrip* RecordedAs(const Recording& recording, size_t grip) {
  const size_t fixed = recording.object.fixed.size();  // the model has these grips first
  return grip < fixed || grip - fixed >= recording.object.grips.size()
             ? nullptr
             : &recording.object.grips[grip - fixed];
}

}  // namespace lacuna
