#include "diagnosis/grip_motions.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <utility>

#include "prediction/grip_placement.h"

namespace lacuna {
namespace {

// A grip in the model of one recording.
struct HeldNodes {
  Grip grip;
  Eigen::Matrix3Xd at_rest;     // 3 × nodes of the grip, m
  Eigen::Index node_count = 0;  // of the body

  HeldNodes(const Model& model, const Grip& own)
      : grip(own),
        at_rest(model.body->mesh.nodes(Eigen::all, own.nodes)),
        node_count(model.body->NodeCount()) {}
  Eigen::Matrix3Xd PlacesAt(double time) const { return grip.motion ? grip.motion(time) : at_rest; }
  double Holds(int axis) const { return grip.axes.Has(axis) ? 1 : 0; }
};

bool AreAlike(const Grip& a, const Grip& b) { return a.axes == b.axes && HoldsExactly(a, b.nodes); }

// The displacements (3n, m per unit of the direction) of the nodes by a motion of their grip, given
// the forces that grips exert on the body (3n, N).
using MotionOfGrip = std::function<Eigen::VectorXd(const HeldNodes& nodes, double time,
                                                   const Eigen::VectorXd& reaction)>;

// A motion of the grip, wherever a recording's model has one like it.
MisfitDirection DirectionOf(const Grip& grip, MotionOfGrip motion) {
  MisfitDirection direction;
  direction.perturbation_in = [grip, motion = std::move(motion)](const Model& placed) {
    Perturbation perturbation;
    const auto own = std::find_if(placed.grips.begin(), placed.grips.end(),
                                  [&](const Grip& other) { return AreAlike(grip, other); });
    if (own != placed.grips.end())
      perturbation.grip = [nodes = std::make_shared<const HeldNodes>(placed, *own), motion](
                              double time, const Eigen::VectorXd& reaction) {
        return motion(*nodes, time, reaction);
      };
    return perturbation;
  };
  return direction;
}

MotionOfGrip RigidMotion(const Eigen::Vector3d& shift, const Eigen::Vector3d& rotation) {
  return [shift, rotation](const HeldNodes& nodes, double time, const Eigen::VectorXd&) {
    return RigidGripMotion(nodes.grip, nodes.PlacesAt(time), shift, rotation, nodes.node_count);
  };
}

// The grip yields to its force, or turns with its moment, whose largest norm is added to
// `largest`.
MotionOfGrip YieldingMotion(bool turns, std::shared_ptr<LargestNorm> largest) {
  return [turns, largest = std::move(largest)](const HeldNodes& nodes, double time,
                                               const Eigen::VectorXd& reaction) {
    const Eigen::Vector3d held(nodes.Holds(0), nodes.Holds(1), nodes.Holds(2));
    const Eigen::Matrix3Xd places = nodes.PlacesAt(time);
    const Eigen::Vector3d centre = places.rowwise().mean();
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      const Eigen::Vector3d here = held.cwiseProduct(reaction.segment<3>(3 * nodes.grip.nodes[i]));
      force += here;
      moment += (places.col(i) - centre).cross(here);
    }
    largest->Add(turns ? moment.norm() : force.norm());
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return RigidGripMotion(nodes.grip, places, turns ? zero : Eigen::Vector3d(-force),
                           turns ? Eigen::Vector3d(-moment) : zero, nodes.node_count);
  };
}

// The grip moves along the axis i by (X − X̄)ⱼ, `entry` = i + 3 j.
MotionOfGrip StrainMotion(int entry) {
  return [entry](const HeldNodes& nodes, double, const Eigen::VectorXd&) {
    const int axis = entry % 3, along = entry / 3;
    const double centre = nodes.at_rest.row(along).mean();
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * nodes.node_count);
    for (Eigen::Index i = 0; i < nodes.at_rest.cols(); ++i)
      motion[3 * nodes.grip.nodes[i] + axis] =
          nodes.Holds(axis) * (nodes.at_rest(along, i) - centre);
    return motion;
  };
}

// Makes the grips of a problem, one after another.
class MotionsBuilder {
 public:
  explicit MotionsBuilder(const CalibrationProblem& problem);
  GripMotions Build() &&;

 private:
  void FindGrips();
  // The grip of earlier recordings that is alike; a new one if there is none.
  GripMotions::Grip& GripLike(const Grip& held, size_t recording);
  bool Deforms(const GripMotions::Grip& grip) const;
  std::string LabelOf(const GripMotions::Grip& grip) const;
  void AddMotions(GripMotions::Grip* grip);

  const CalibrationProblem& problem_;
  std::vector<size_t> fitted_;  // the indices of the fitted recordings
  GripMotions motions_;
};

MotionsBuilder::MotionsBuilder(const CalibrationProblem& problem) : problem_(problem) {
  for (size_t r = 0; r < problem.models().size(); ++r)
    if (problem.models()[r].recording().fitted) fitted_.push_back(r);
}

GripMotions MotionsBuilder::Build() && {
  FindGrips();
  for (GripMotions::Grip& grip : motions_.grips) AddMotions(&grip);
  return std::move(motions_);
}

void MotionsBuilder::FindGrips() {
  for (const size_t recording : fitted_) {
    const std::vector<Grip>& grips = problem_.models()[recording].model().grips;
    for (size_t g = 0; g < grips.size(); ++g)
      if (grips[g].nodes.size() > 0) GripLike(grips[g], recording).index_in[recording] = g;
  }
}

GripMotions::Grip& MotionsBuilder::GripLike(const Grip& held, size_t recording) {
  for (GripMotions::Grip& known : motions_.grips)
    if (!known.In(recording) && AreAlike(FirstOf(known, problem_), held)) return known;
  return motions_.grips.emplace_back();
}

bool MotionsBuilder::Deforms(const GripMotions::Grip& grip) const {
  return std::any_of(grip.index_in.begin(), grip.index_in.end(), [&](const auto& place) {
    const RecordedGrip* recorded =
        RecordedAs(problem_.models()[place.first].measured(), place.second);
    return recorded != nullptr && recorded->deforms;
  });
}

std::string MotionsBuilder::LabelOf(const GripMotions::Grip& grip) const {
  const auto& [recording, index] = *grip.index_in.begin();
  const std::string label = problem_.models()[recording].model().grips.size() > 1
                                ? fmt::format("grip {}", index + 1)
                                : std::string("the grip");
  if (grip.index_in.size() == fitted_.size()) return label;
  return fmt::format("{} of {}", label, problem_.models()[recording].recording().name);
}

void MotionsBuilder::AddMotions(GripMotions::Grip* grip) {
  std::vector<MisfitDirection>& directions = motions_.directions;
  const auto next = [&] { return static_cast<Eigen::Index>(directions.size()); };
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Grip& held = FirstOf(*grip, problem_);
  grip->label = LabelOf(*grip);
  grip->force = std::make_shared<LargestNorm>();
  grip->moment = std::make_shared<LargestNorm>();
  grip->rigid = next();
  for (int axis = 0; axis < 3; ++axis)
    directions.push_back(DirectionOf(held, RigidMotion(Eigen::Vector3d::Unit(axis), zero)));
  for (int axis = 0; axis < 3; ++axis)
    directions.push_back(DirectionOf(held, RigidMotion(zero, Eigen::Vector3d::Unit(axis))));
  grip->yielding = next();
  directions.push_back(DirectionOf(held, YieldingMotion(/*turns=*/false, grip->force)));
  directions.push_back(DirectionOf(held, YieldingMotion(/*turns=*/true, grip->moment)));
  if (!Deforms(*grip)) return;
  grip->strain = next();
  for (int entry = 0; entry < 9; ++entry)
    directions.push_back(DirectionOf(held, StrainMotion(entry)));
}

}  // namespace

std::optional<size_t> GripMotions::Grip::In(size_t recording) const {
  const auto found = index_in.find(recording);
  if (found == index_in.end()) return std::nullopt;
  return found->second;
}

const Grip& FirstOf(const GripMotions::Grip& grip, const CalibrationProblem& problem) {
  const auto& [recording, index] = *grip.index_in.begin();
  return problem.models()[recording].model().grips[index];
}

bool HoldsExactly(const Grip& grip, const Eigen::VectorXi& nodes) {
  return grip.nodes.size() == nodes.size() && grip.nodes == nodes;
}

GripMotions MakeGripMotions(const CalibrationProblem& problem) {
  return MotionsBuilder(problem).Build();
}

LinearisedWithGrips LineariseWithGrips(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       std::vector<MisfitDirection> directions,
                                       const std::function<void()>& on_frame) {
  LinearisedWithGrips linearised;
  linearised.grips = MakeGripMotions(problem);
  linearised.parameters = static_cast<Eigen::Index>(problem.parameters().size());
  linearised.directions = static_cast<Eigen::Index>(directions.size());
  const std::vector<MisfitDirection>& of_grips = linearised.grips.directions;
  directions.insert(directions.end(), of_grips.begin(), of_grips.end());
  linearised.misfit = problem.Linearise(
      values, {.with_jacobian = true, .directions = directions, .on_frame = on_frame});
  return linearised;
}

const RecordedGrip* RecordedAs(const Recording& recording, size_t grip) {
  const size_t fixed = recording.object.fixed.size();  // the model has these grips first
  return grip < fixed || grip - fixed >= recording.object.grips.size()
             ? nullptr
             : &recording.object.grips[grip - fixed];
}

}  // namespace lacuna
