#include "standard/solution.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "core/error.h"
#include "experiment/held_parts.h"
#include "fem/natural_modes.h"
#include "fem/nodal_recovery.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Newton iterations are continued to this residual relative to the acting forces, so that their
// error does not show beside that of the mesh.
constexpr double kTolerance = 1e-11;

// The share of each node (sum 1) in a uniform load along the edge that the nodes form: half of the
// length of each segment for both of its ends, and by Simpson's rule for quadratic elements.
Eigen::VectorXd LineShares(const TetMesh& mesh, const Eigen::VectorXi& nodes) {
  const std::set<int> on_line(nodes.begin(), nodes.end());
  std::set<std::pair<int, int>> seen;
  Eigen::VectorXd share = Eigen::VectorXd::Zero(mesh.NodeCount());
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e)
    for (int k = 0; k < 6; ++k) {
      const auto [first, second] = kTetEdges[static_cast<size_t>(k)];
      const int a = mesh.tets(first, e), b = mesh.tets(second, e);
      if (on_line.count(a) == 0 || on_line.count(b) == 0 || !seen.insert(std::minmax(a, b)).second)
        continue;
      const double length = (mesh.nodes.col(a) - mesh.nodes.col(b)).norm();
      const bool is_quadratic = mesh.Order() == 2;
      share[a] += length / (is_quadratic ? 6 : 2);
      share[b] += length / (is_quadratic ? 6 : 2);
      if (is_quadratic) share[mesh.tets(4 + k, e)] += length * 4 / 6;
    }
  CHECK_GT(share.sum(), 0) << "a line load on nodes that form no edge";
  return share / share.sum();
}

// The area of the boundary of the body that the nodes span, m².
double AreaOf(const Body& body, const Eigen::VectorXi& nodes) {
  std::vector<char> inside(static_cast<size_t>(body.NodeCount()), 0);
  for (const int node : nodes) inside[static_cast<size_t>(node)] = 1;
  const TriMesh& surface = body.boundary.surface;
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    if (!std::all_of(corners.begin(), corners.end(), [&](int vertex) {
          return inside[static_cast<size_t>(body.boundary.node[static_cast<size_t>(vertex)])];
        }))
      continue;
    const Eigen::Vector3d a = surface.vertices.col(corners[0]);
    area +=
        0.5 *
        (surface.vertices.col(corners[1]) - a).cross(surface.vertices.col(corners[2]) - a).norm();
  }
  return area;
}

std::function<Eigen::Matrix3Xd(double)> MotionOf(const ProblemSupport& support,
                                                 const Eigen::Matrix3Xd& rest) {
  return [support, rest](double time) -> Eigen::Matrix3Xd {
    const double share = support.profile.At(time);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(share * support.angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return (turn * (rest.colwise() - support.centre)).colwise() +
           (support.centre + share * support.translation);
  };
}

// The supports as grips; where they meet, nodes belong to them as those of a recording do.
std::vector<Grip> MakeGrips(const Problem& problem, const MappedBlock& block) {
  std::vector<HeldPart> parts;
  for (const ProblemSupport& support : problem.supports) {
    const Eigen::VectorXi nodes = block.NodesOf(support.part);
    parts.push_back({{support.name, NodeRegion{{nodes.begin(), nodes.end()}, {}}},
                     support.axes,
                     support.Moves()});
  }
  const std::vector<Eigen::VectorXi> held = NodesOfParts(parts, block.mesh);
  std::vector<Grip> grips;
  for (size_t k = 0; k < held.size(); ++k) {
    const ProblemSupport& support = problem.supports[k];
    grips.push_back({held[k], {}, support.axes});
    if (support.Moves())
      grips.back().motion = MotionOf(support, block.mesh.nodes(Eigen::all, held[k]));
  }
  return grips;
}

Model MakeModel(const Problem& problem, const MappedBlock& block) {
  Model model{std::make_shared<Body>(MakeBody(block.mesh, problem.density)), problem.effects,
              MakeGrips(problem, block)};
  for (const ProblemLoad& load : problem.loads) {
    const Eigen::VectorXi nodes = block.NodesOf(load.part);
    const bool is_line = !load.line_force.isZero(0);
    const Eigen::Vector3d force =
        is_line ? load.line_force : Eigen::Vector3d(AreaOf(*model.body, nodes) * load.traction);
    model.effects.push_back(std::make_shared<PrescribedForce>(
        is_line ? LineShares(block.mesh, nodes) : BoundaryShares(*model.body, nodes),
        [force, profile = load.profile](double time) {
          return Eigen::Vector3d(profile.At(time) * force);
        }));
  }
  return model;
}

double EnergyOf(const Model& model, const MotionHistory& at) {
  const Body& body = *model.body;
  double energy = 0;
  for (int node = 0; node < body.NodeCount(); ++node)
    energy += 0.5 * body.node_mass[node] * at.velocity.segment<3>(3 * node).squaredNorm();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(at.position.size());
  for (size_t j = 0; j < model.effects.size(); ++j)
    energy += model.effects[j]
                  ->Energy({body, at.position, at.velocity, zero, at.time, 0, at.effect_state[j],
                            ElasticityOf(model)})
                  .value_or(kUnknown);
  return energy;
}

class Solver {
 public:
  Solver(const Problem& problem, const ProblemMesh& mesh, int order)
      : problem_(problem),
        block_(MeshBlock(problem.map, mesh.cells, order)),
        model_(MakeModel(problem, block_)),
        steps_(mesh.steps) {}

  ProblemSolution Run() {
    ProblemSolution solution;
    solution.nodes = model_.body->NodeCount();
    if (problem_.kind == ProblemKind::kModes)
      FindModes(&solution);
    else
      Move(&solution);
    return solution;
  }

 private:
  void FindModes(ProblemSolution* solution) {
    int highest = 0;
    for (const Wanted& wanted : problem_.wanted) highest = std::max(highest, wanted.mode);
    const NaturalModes modes = FindNaturalModes(model_, RestHistory(model_).position, highest);
    solution->message = modes.message;
    if (!modes.IsUsable()) return;
    for (const Wanted& wanted : problem_.wanted)
      solution->values.push_back(modes.frequencies[wanted.mode - 1]);
  }

  void Move(ProblemSolution* solution) {
    StepOptions options;
    options.relative_tolerance = kTolerance;
    options.linear.relative_tolerance = kTolerance;
    options.scheme =
        problem_.kind == ProblemKind::kMotion ? problem_.scheme : TimeScheme::kQuasiStatic;
    Stepper stepper(model_, options);
    history_ = RestHistory(model_);
    history_.velocity = problem_.velocity.replicate(model_.body->NodeCount(), 1);
    start_energy_ = EnergyOf(model_, history_);
    const bool is_static = problem_.kind == ProblemKind::kStatic;
    time_step_ = is_static ? 0 : problem_.duration / steps_;
    solution->values.assign(problem_.wanted.size(), kUnknown);
    const int steps = is_static ? 1 : steps_;
    for (int k = 0; k < steps; ++k) {
      before_ = history_;
      const StepSummary step =
          is_static ? stepper.Equilibrium({}, &history_) : stepper.Step(time_step_, {}, &history_);
      if (!step.IsUsable()) {
        solution->message = step.message;
        return;
      }
      for (size_t i = 0; i < problem_.wanted.size(); ++i) {
        const Wanted& wanted = problem_.wanted[i];
        const bool is_now = wanted.time == 0
                                ? k + 1 == steps
                                : std::abs(history_.time - wanted.time) < 1e-6 * time_step_;
        if (is_now) solution->values[i] = ValueOf(wanted);
      }
    }
  }

  Eigen::Index NodeAt(const BlockPart& point) const {
    const Eigen::VectorXi nodes = block_.NodesOf(point);
    if (nodes.size() != 1)
      throw InputError(
          fmt::format("{}: `at` names {} nodes instead of one", problem_.name, nodes.size()));
    return nodes[0];
  }

  double ValueOf(const Wanted& wanted) const {
    switch (wanted.kind) {
      case Wanted::Kind::kDisplacement: {
        const Eigen::Index node = NodeAt(wanted.point);
        return history_.position[3 * node + wanted.component] -
               block_.mesh.nodes(wanted.component, node);
      }
      case Wanted::Kind::kStress:
        return Stress().cauchy(wanted.component, NodeAt(wanted.point));
      case Wanted::Kind::kVonMises:
        return Stress().von_mises[NodeAt(wanted.point)];
      case Wanted::Kind::kReaction:
        return ReactionsOf(wanted.support).rowwise().sum()[wanted.component];
      case Wanted::Kind::kTorque:
        return TorqueOf(wanted.support);
      case Wanted::Kind::kVelocity: {
        const Eigen::VectorXd& mass = model_.body->node_mass;
        return (history_.velocity.reshaped(3, mass.size()) * mass)[wanted.component] / mass.sum();
      }
      case Wanted::Kind::kEnergy:
        return EnergyOf(model_, history_) / start_energy_;
      case Wanted::Kind::kFrequency:
        break;
    }
    return kUnknown;
  }

  NodalStress Stress() const {
    return RecoverNodalStress(model_, history_.position, history_.velocity, history_.time,
                              history_.effect_state);
  }

  size_t SupportNamed(const std::string& name) const {
    for (size_t k = 0; k < problem_.supports.size(); ++k)
      if (problem_.supports[k].name == name) return k;
    throw InputError(fmt::format("{}: there is no support \"{}\"", problem_.name, name));
  }

  // The force that the support exerts on each of its nodes along its axes, 3 × nodes.
  Eigen::Matrix3Xd ReactionsOf(const std::string& name) const {
    const size_t support = SupportNamed(name);
    const StepEquation equation(
        model_, before_,
        problem_.kind == ProblemKind::kMotion ? problem_.scheme : TimeScheme::kQuasiStatic,
        time_step_);
    Eigen::VectorXd residual;
    equation.Residual(history_.position, &residual);
    const Grip& grip = model_.grips[support];
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, grip.nodes.size());
    for (Eigen::Index k = 0; k < grip.nodes.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (grip.axes.Has(axis)) forces(axis, k) = residual[3 * grip.nodes[k] + axis];
    return forces;
  }

  double TorqueOf(const std::string& name) const {
    const ProblemSupport& support = problem_.supports[SupportNamed(name)];
    const Grip& grip = model_.grips[SupportNamed(name)];
    const Eigen::Matrix3Xd forces = ReactionsOf(name);
    double torque = 0;
    for (Eigen::Index k = 0; k < grip.nodes.size(); ++k) {
      const Eigen::Vector3d arm = history_.position.segment<3>(3 * grip.nodes[k]) - support.centre;
      torque += arm.cross(Eigen::Vector3d(forces.col(k))).z();
    }
    return torque;
  }

  const Problem& problem_;
  MappedBlock block_;
  Model model_;
  int steps_;
  double time_step_ = 0, start_energy_ = 0;
  MotionHistory history_, before_;
};

}  // namespace

ProblemSolution Solve(const Problem& problem, const ProblemMesh& mesh, int order) {
  const auto start = std::chrono::steady_clock::now();
  ProblemSolution solution = Solver(problem, mesh, order).Run();
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return solution;
}

double RefinementStudy::Error(const Problem& problem, size_t mesh, size_t wanted) const {
  if (!solutions[mesh].IsUsable()) return kUnknown;
  const double published = problem.wanted[wanted].value;
  return std::abs(solutions[mesh].values[wanted] - published) / std::abs(published);
}

double RefinementStudy::ObservedOrder(const Problem& problem, size_t wanted) const {
  if (solutions.size() < 2) return kUnknown;
  const size_t last = solutions.size() - 1;
  const ProblemMesh &coarse = problem.meshes[last - 1], &fine = problem.meshes[last];
  const double finer = coarse.cells[0] != fine.cells[0]
                           ? static_cast<double>(fine.cells[0]) / coarse.cells[0]
                           : static_cast<double>(fine.steps) / coarse.steps;
  return std::log(Error(problem, last - 1, wanted) / Error(problem, last, wanted)) /
         std::log(finer);
}

RefinementStudy Refine(const Problem& problem, int order, int count) {
  RefinementStudy study{order, {}};
  for (int k = 0; k < count; ++k)
    study.solutions.push_back(Solve(problem, problem.meshes[static_cast<size_t>(k)], order));
  return study;
}

}  // namespace lacuna
