#include <algorithm>
#include <cmath>
#include <limits>

#include "comparison/unexplained_force.h"

namespace lacuna {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s²
constexpr int kShapes = SmoothForce::kShapes;

// Weights of all amplitudes in what is linear (rows × 6) in the force at one time.
Eigen::MatrixXd OverKnots(const SmoothForce& force, const Eigen::MatrixXd& by, double time) {
  const SmoothForce::Between at = force.At(time);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(by.rows(), force.amplitudes.size());
  all.middleCols<kShapes>(kShapes * at.knot) = (1 - at.next) * by;
  all.middleCols<kShapes>(kShapes * (at.knot + 1)) = at.next * by;
  return all;
}

Eigen::VectorXd Deviations(const Eigen::MatrixXd& weights, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd deviations(weights.rows());
  for (Eigen::Index k = 0; k < weights.rows(); ++k) {
    // At one time all but 12 weights are 0.
    std::vector<Eigen::Index> active;
    for (Eigen::Index c = 0; c < weights.cols(); ++c)
      if (weights(k, c) != 0) active.push_back(c);
    const Eigen::RowVectorXd row = weights(k, active);
    const Eigen::MatrixXd among = covariance(active, active);
    deviations[k] = std::sqrt(std::max(row.dot(row * among), 0.0));
  }
  return deviations;
}

double CorrelationOver(const Eigen::Matrix3Xd& force, const Eigen::Matrix3Xd& motion) {
  const Eigen::Matrix3Xd a = force.colwise() - force.rowwise().mean();
  const Eigen::Matrix3Xd b = motion.colwise() - motion.rowwise().mean();
  const double product = a.norm() * b.norm();
  return product > 0 ? a.cwiseProduct(b).sum() / product : 0;
}

void MeasurePlace(const Model& model, const ReplayedMotion& motion, UnexplainedForce* force) {
  const Body& body = *model.body;
  const std::vector<char> held = GrippedNodes(model);
  force->place = Eigen::Matrix3Xd::Zero(3, force->times.size());
  Eigen::VectorXd all = Eigen::VectorXd::Zero(body.NodeCount());
  for (Eigen::Index k = 0; k < force->times.size(); ++k) {
    const Eigen::VectorXd amount = force->field.DensityAt(motion.states[k].time)
                                       .colwise()
                                       .norm()
                                       .transpose()
                                       .cwiseProduct(body.node_mass);
    if (amount.sum() > 0) force->place.col(k) = body.mesh.nodes * amount / amount.sum();
    all += amount;
  }
  if (all.sum() > 0) force->mean_place = body.mesh.nodes * all / all.sum();
  if (std::none_of(held.begin(), held.end(), [](char is) { return is != 0; })) return;
  const auto distance = [&](const Eigen::Vector3d& from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < body.mesh.nodes.cols(); ++i)
      if (held[i]) nearest = std::min(nearest, (body.mesh.nodes.col(i) - from).norm());
    return nearest;
  };
  force->grip_distance = distance(force->mean_place);
  for (Eigen::Index i = 0; i < body.mesh.nodes.cols(); ++i)
    force->farthest = std::max(force->farthest, distance(body.mesh.nodes.col(i)));
}

// The net force (3 × 6) and the torque about `centre` of unit amplitudes.
struct Resultants {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, kShapes);
  Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(3, kShapes);
};
Resultants ResultantsOf(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& position,
                        const Eigen::Vector3d& centre) {
  Resultants resultants;
  for (Eigen::Index i = 0; 3 * i < position.size(); ++i) {
    const Eigen::Vector3d arm = position.segment<3>(3 * i) - centre;
    const Eigen::Matrix3d cross{
        {0, -arm.z(), arm.y()}, {arm.z(), 0, -arm.x()}, {-arm.y(), arm.x(), 0}};
    resultants.force += shapes.middleRows<3>(3 * i);
    resultants.torque += cross * shapes.middleRows<3>(3 * i);
  }
  return resultants;
}

bool StandsOut(const UnexplainedForce& force) {
  constexpr double kClear = 2, kClearWork = 3, kEvident = 5;
  if (!(force.evidence > kEvident)) return false;
  if (std::abs(force.work) > kClearWork * force.work_deviation) return true;
  return (force.rms.array() > kClear * force.rms_deviation.array()).any() ||
         (force.mean_force.array().abs() > kClear * force.mean_deviation.array()).any();
}

}  // namespace

void MeasureForce(const Model& model, const ReplayedMotion& motion,
                  const Eigen::MatrixXd& covariance, UnexplainedForce* force) {
  const Body& body = *model.body;
  const SmoothForce& field = force->field;
  const Eigen::MatrixXd shapes = field.Shapes();
  const Eigen::VectorXd mass = body.node_mass.cwiseProduct(field.modes.col(0));
  const Eigen::Vector3d centroid = body.mesh.nodes * body.node_mass / body.node_mass.sum();
  const Eigen::Index count = static_cast<Eigen::Index>(motion.states.size());
  force->weight = mass.sum() * kStandardGravity;
  force->delay = motion.delay;
  force->times.resize(count);
  force->power.resize(count);
  for (Eigen::Matrix3Xd* rows :
       {&force->force, &force->force_deviation, &force->torque, &force->torque_deviation})
    rows->resize(3, count);

  Eigen::MatrixXd mean_by = Eigen::MatrixXd::Zero(3, field.amplitudes.size());
  Eigen::MatrixXd work_by = Eigen::MatrixXd::Zero(1, field.amplitudes.size());
  Eigen::Matrix3Xd displacement(3, count), velocity(3, count), acceleration(3, count);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = sum, variances = sum;
  double duration = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const TrajectoryState& state = motion.states[k];
    const Eigen::VectorXd amplitudes = field.AmplitudesAt(state.time);
    const Resultants by = ResultantsOf(shapes, state.position, centroid);
    const Eigen::MatrixXd power_by = state.velocity.transpose() * shapes;
    const Eigen::MatrixXd force_over_knots = OverKnots(field, by.force, state.time);
    force->times[k] = state.time + motion.delay;
    force->force.col(k) = by.force * amplitudes;
    force->torque.col(k) = by.torque * amplitudes;
    force->power[k] = (power_by * amplitudes)(0);
    force->force_deviation.col(k) = Deviations(force_over_knots, covariance);
    force->torque_deviation.col(k) =
        Deviations(OverKnots(field, by.torque, state.time), covariance);

    // The trapezoidal rule.
    const double from = motion.states[std::max<Eigen::Index>(k - 1, 0)].time;
    const double to = motion.states[std::min(k + 1, count - 1)].time;
    const double share = 0.5 * (to - from);
    duration += share;
    mean_by += share * force_over_knots;
    work_by += share * OverKnots(field, power_by, state.time);
    sum += share * force->force.col(k);
    squares += share * force->force.col(k).cwiseAbs2();
    variances += share * force->force_deviation.col(k).cwiseAbs2();
    force->work += share * force->power[k];
    const auto of_mass = [&](const Eigen::VectorXd& nodal) -> Eigen::Vector3d {
      return nodal.reshaped(3, mass.size()) * mass / mass.sum();
    };
    displacement.col(k) = of_mass(state.position - body.mesh.nodes.reshaped());
    velocity.col(k) = of_mass(state.velocity);
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index a = std::max<Eigen::Index>(k - 1, 0), b = std::min(k + 1, count - 1);
    acceleration.col(k) =
        (velocity.col(b) - velocity.col(a)) / (motion.states[b].time - motion.states[a].time);
  }
  force->mean_force = sum / duration;
  force->mean_deviation = Deviations(mean_by, covariance) / duration;
  force->rms = (squares / duration).cwiseSqrt();
  force->rms_deviation = (variances / duration).cwiseSqrt();
  if (force->rms.norm() > 0) force->constant_share = force->mean_force.norm() / force->rms.norm();
  force->work_deviation = Deviations(work_by, covariance)[0];
  force->mean_power = force->work / duration;
  force->likeness = {{"displacement", CorrelationOver(force->force, displacement)},
                     {"velocity", CorrelationOver(force->force, velocity)},
                     {"acceleration", CorrelationOver(force->force, acceleration)}};
  MeasurePlace(model, motion, force);
  force->stands_out = StandsOut(*force);
}

}  // namespace lacuna
