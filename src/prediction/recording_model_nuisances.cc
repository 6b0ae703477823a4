// The nuisance parameters of a recording: which there are, and what they change.
#include <fmt/format.h>
#include <glog/logging.h>

#include <utility>

#include "core/error.h"
#include "experiment/reference_body.h"
#include "fem/prescribed_force.h"
#include "geometry/rotation.h"
#include "prediction/recording_model.h"

namespace lacuna {
namespace {

using Kind = MisfitDirection::Kind;

}  // namespace

void RecordingModel::AddNuisance(const std::string& name, const std::string& unit, double deviation,
                                 MisfitDirection direction) {
  Nuisance nuisance;
  nuisance.prior.name = recording_.name + "." + name;
  nuisance.prior.prior_deviation = nuisance.prior.typical = deviation;
  nuisance.direction = std::move(direction);
  nuisance.unit = unit;
  nuisances_.push_back(std::move(nuisance));
}

void RecordingModel::AddNuisances(const TetMesh& mesh) {
  if (recording_.hold) AddHold(mesh);
  if (recording_.clock_deviation > 0)
    AddNuisance("clock", "s", recording_.clock_deviation, {Kind::kClock});
  for (size_t k = 0; k < Reactions().size(); ++k) {
    const MeasuredReaction& reading = Reactions()[k];
    if (reading.delay_deviation > 0)
      AddNuisance(fmt::format("{}.{}_delay", reading.name, reading.Quantity()), "s",
                  reading.delay_deviation, {.kind = Kind::kCellDelay, .reading = k});
  }
  for (const bool turns : {false, true}) {
    const double deviation = turns ? recording_.turn_deviation : recording_.shift_deviation;
    for (int axis = 0; deviation > 0 && axis < 3; ++axis)
      AddNuisance(fmt::format("{}_{}", turns ? "turn" : "shift", "xyz"[axis]), turns ? "rad" : "m",
                  deviation, {turns ? Kind::kTurn : Kind::kShift, axis});
  }
  AddPlacements();
}

void RecordingModel::AddHold(const TetMesh& mesh) {
  const std::string where = study_.file.string() + ": hold of " + recording_.name;
  const std::vector<int> nodes =
      NamingWhere(where, [&] { return SelectNodes(recording_.hold->region, mesh); });
  const Eigen::VectorXi chosen =
      Eigen::Map<const Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
  const Eigen::VectorXd areas = NodeBoundaryAreas(*model_.body);
  if (areas(chosen).sum() == 0)
    throw InputError(where + " touches no boundary node: its region is too small");
  const Eigen::VectorXd share = BoundaryShares(*model_.body, chosen);
  const double weight = 10 * model_.body->node_mass.sum();  // N, about the weight of the object
  for (int axis = 0; axis < 3; ++axis) {
    MisfitDirection direction;
    Eigen::VectorXd& force = direction.perturbation.held_force;
    force = Eigen::VectorXd::Zero(3 * share.size());
    for (Eigen::Index i = 0; i < share.size(); ++i) force[3 * i + axis] = share[i];
    AddNuisance(fmt::format("hold_force_{}", "xyz"[axis]), "N", weight, std::move(direction));
    if (!recording_.hold->force) continue;
    nuisances_.back().prior.prior_mean = 0;
    nuisances_.back().prior.start = (*recording_.hold->force)[axis];
  }
}

void RecordingModel::AddPlacements() {
  const RecordedObject& object = recording_.recording.object;
  const std::vector<std::string> names = HeldParts(object);
  const std::vector<PlacementDeviation> deviations = PlacementDeviationsOfParts(object);
  for (size_t grip = 0; grip < deviations.size(); ++grip) {
    for (const bool turns : {false, true}) {
      const double deviation = turns ? deviations[grip].turn : deviations[grip].shift;
      for (int axis = 0; deviation > 0 && axis < 3; ++axis) {
        MisfitDirection direction{turns ? Kind::kGripTurn : Kind::kGripShift, axis};
        direction.grip = grip;
        AddNuisance(fmt::format("{}.{}_{}", names[grip], turns ? "turn" : "shift", "xyz"[axis]),
                    turns ? "rad" : "m", deviation, std::move(direction));
      }
    }
  }
}

GripPlacement RecordingModel::PlacementOf(size_t grip, const Eigen::VectorXd& nuisance) const {
  GripPlacement placement;
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    const MisfitDirection& direction = nuisances_[k].direction;
    if (!direction.IsOfGrip() || direction.grip != grip) continue;
    (direction.kind == Kind::kGripTurn ? placement.turn : placement.shift)[direction.axis] =
        nuisance[static_cast<Eigen::Index>(k)];
  }
  return placement;
}

Perturbation RecordingModel::PerturbationOf(const MisfitDirection& direction,
                                            const Eigen::VectorXd& nuisance,
                                            const Model& placed) const {
  if (direction.perturbation_in) return direction.perturbation_in(placed);
  if (!direction.IsOfGrip()) return direction.perturbation;
  Perturbation perturbation;
  perturbation.grip = PlacementDerivative(model_.grips[direction.grip], model_.body->mesh.nodes,
                                          PlacementOf(direction.grip, nuisance),
                                          direction.kind == Kind::kGripTurn, direction.axis);
  return perturbation;
}

Model RecordingModel::PlacedModel(const Eigen::VectorXd& nuisance) const {
  CHECK_EQ(nuisance.size(), static_cast<Eigen::Index>(nuisances_.size()));
  const std::vector<PlacementDeviation> placements =
      PlacementDeviationsOfParts(recording_.recording.object);
  Model placed = model_;
  for (size_t grip = 0; grip < placements.size(); ++grip)
    if (!placements[grip].IsExact())
      placed.grips[grip] =
          PlacedGrip(model_.grips[grip], model_.body->mesh.nodes, PlacementOf(grip, nuisance));
  return placed;
}

PredictionOptions RecordingModel::Options(const Eigen::VectorXd& nuisance) const {
  CHECK_EQ(nuisance.size(), static_cast<Eigen::Index>(nuisances_.size()));
  PredictionOptions options;
  options.start_time = recording_.StartTime();
  options.time_step = study_.time_step;
  options.step.scheme = study_.scheme;
  // Far below the error of the time steps. Smaller tolerances take a quarter more time.
  options.step.relative_tolerance = 1e-6;
  options.step.linear.relative_tolerance = 1e-4;
  // Derivatives that are off by 1e-4 lead a fit the same way.
  options.sensitivity_tolerance = 1e-4;
  options.held_force = Eigen::VectorXd::Zero(3 * model_.body->NodeCount());
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    const Eigen::VectorXd& force = nuisances_[k].direction.perturbation.held_force;
    if (force.size() > 0) options.held_force += nuisance[static_cast<Eigen::Index>(k)] * force;
  }
  return options;
}

double RecordingModel::Delay(const Eigen::VectorXd& nuisance) const {
  double late = 0;
  for (size_t k = 0; k < nuisances_.size(); ++k)
    if (nuisances_[k].direction.kind == Kind::kClock)
      late += nuisance[static_cast<Eigen::Index>(k)];
  return late;
}

double RecordingModel::CellDelay(size_t reading, const Eigen::VectorXd& nuisance) const {
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    const MisfitDirection& direction = nuisances_[k].direction;
    if (direction.kind == Kind::kCellDelay && direction.reading == reading)
      return nuisance[static_cast<Eigen::Index>(k)];
  }
  return 0;
}

Eigen::Isometry3d RecordingModel::Registration(const Eigen::VectorXd& nuisance) const {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < nuisances_.size(); ++k) {
    const MisfitDirection& direction = nuisances_[k].direction;
    if (direction.kind == Kind::kShift)
      shift[direction.axis] = nuisance[static_cast<Eigen::Index>(k)];
    if (direction.kind == Kind::kTurn)
      turn[direction.axis] = nuisance[static_cast<Eigen::Index>(k)];
  }
  Eigen::Isometry3d registration = Eigen::Isometry3d::Identity();
  if (shift.isZero(0) && turn.isZero(0)) return registration;
  const Eigen::Vector3d middle = Middle();
  registration.linear() = RotationBy(turn);
  registration.translation() = middle + shift - registration.linear() * middle;
  return registration;
}

Eigen::Vector3d RecordingModel::RegistrationDerivative(const MisfitDirection& direction,
                                                       const Eigen::Isometry3d& registration,
                                                       const Eigen::Vector3d& place) const {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(direction.axis);
  if (direction.kind == Kind::kShift) return axis;
  return axis.cross(place - registration * Middle());
}

}  // namespace lacuna
