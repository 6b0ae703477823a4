#include "diagnosis/grip_motions.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "prediction/grip_placement.h"

namespace lacuna {
namespace {

struct GripNodes {
  Grip grip;
  Eigen::Matrix3Xd places;  // of its nodes at rest, m
  Eigen::Vector3d centre;
  Eigen::Vector3d held;  // 1 along the axes along which the grip holds its nodes, else 0
};

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
    for (const int node : grip.grip.nodes) {
      const Eigen::Vector3d here = grip.held.cwiseProduct(reaction.segment<3>(3 * node));
      force += here;
      moment += (rest.col(node) - grip.centre).cross(here);
    }
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Eigen::VectorXd motion =
        RigidGripMotion(grip.grip, grip.places, turns ? zero : Eigen::Vector3d(-force),
                        turns ? Eigen::Vector3d(-moment) : zero, rest.cols());
    largest->Add(turns ? moment.norm() : force.norm());
    return motion;
  };
  return direction;
}

MisfitDirection StrainMotion(const GripNodes& grip, const Eigen::Matrix3Xd& rest, int entry) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * rest.cols());
  for (const int node : grip.grip.nodes)
    motion[3 * node + entry % 3] =
        grip.held[entry % 3] * (rest(entry / 3, node) - grip.centre[entry / 3]);
  return ConstantMotion(std::move(motion));
}

bool Deforms(const CalibrationProblem& problem, size_t grip) {
  return std::any_of(problem.models().begin(), problem.models().end(), [&](const auto& model) {
    const RecordedGrip* recorded = RecordedAs(model.measured(), grip);
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
    if (model.grips[g].nodes.size() == 0) continue;
    GripNodes nodes{model.grips[g], rest(Eigen::all, model.grips[g].nodes), zero, zero};
    nodes.centre = nodes.places.rowwise().mean();
    for (int axis = 0; axis < 3; ++axis) nodes.held[axis] = model.grips[g].axes.Has(axis);
    GripMotions::Grip& grip = motions.grips.emplace_back();
    grip.grip = g;
    grip.label = model.grips.size() > 1 ? fmt::format("grip {}", g + 1) : "the grip";
    grip.force = std::make_shared<LargestNorm>();
    grip.moment = std::make_shared<LargestNorm>();
    grip.rigid = next();
    for (int axis = 0; axis < 6; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis % 3);
      directions.push_back(ConstantMotion(RigidGripMotion(
          nodes.grip, nodes.places, axis < 3 ? unit : zero, axis < 3 ? zero : unit, rest.cols())));
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

LinearisedWithGrips LineariseWithGrips(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       std::vector<MisfitDirection> directions) {
  LinearisedWithGrips linearised;
  linearised.grips = MakeGripMotions(problem);
  linearised.parameters = static_cast<Eigen::Index>(problem.parameters().size());
  linearised.directions = static_cast<Eigen::Index>(directions.size());
  const std::vector<MisfitDirection>& of_grips = linearised.grips.directions;
  directions.insert(directions.end(), of_grips.begin(), of_grips.end());
  linearised.misfit = problem.Linearise(values, {.with_jacobian = true, .directions = directions});
  return linearised;
}

const RecordedGrip* RecordedAs(const Recording& recording, size_t grip) {
  const size_t fixed = recording.object.fixed.size();  // the model has these grips first
  return grip < fixed || grip - fixed >= recording.object.grips.size()
             ? nullptr
             : &recording.object.grips[grip - fixed];
}

}  // namespace lacuna
