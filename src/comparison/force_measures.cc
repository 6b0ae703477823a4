#include "comparison/force_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "effects/free_fall.h"

namespace lacuna {
namespace {

constexpr int kShapes = SmoothForce::kShapes;

// The Jacobian by the amplitudes at all knots (rows × 6·knots) of a quantity whose Jacobian by the
// amplitudes at one time is `jacobian` (rows × 6).
Eigen::MatrixXd JacobianOverKnots(const SmoothForce& force, const Eigen::MatrixXd& jacobian,
                                  double time) {
  const SmoothForce::KnotWeight at = force.At(time);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(jacobian.rows(), force.amplitudes.size());
  all.middleCols<kShapes>(kShapes * at.knot) = (1 - at.next) * jacobian;
  all.middleCols<kShapes>(kShapes * (at.knot + 1)) = at.next * jacobian;
  return all;
}

// Standard deviations of quantities that depend linearly, by `jacobian`, on amplitudes with this
// covariance.
Eigen::VectorXd Deviations(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd deviations(jacobian.rows());
  for (Eigen::Index k = 0; k < jacobian.rows(); ++k) {
    // A quantity at one time has at most 12 nonzero entries.
    std::vector<Eigen::Index> active;
    for (Eigen::Index c = 0; c < jacobian.cols(); ++c)
      if (jacobian(k, c) != 0) active.push_back(c);
    const Eigen::RowVectorXd row = jacobian(k, active);
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

// The Jacobians of the net force and of the torque about `centre` by the amplitudes, 3 × 6 each.
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

// The weight, s, of state `k` in an integral over time by the trapezoidal rule.
double TrapezoidalWeight(const ReplayedMotion& motion, Eigen::Index k) {
  const Eigen::Index count = static_cast<Eigen::Index>(motion.states.size());
  const double from = motion.states[std::max<Eigen::Index>(k - 1, 0)].time;
  const double to = motion.states[std::min(k + 1, count - 1)].time;
  return 0.5 * (to - from);
}

// The net force, torque and power over time, and their means.
void MeasureHistory(const Model& model, const ReplayedMotion& motion,
                    const Eigen::MatrixXd& covariance, UnexplainedForce* force) {
  const Body& body = *model.body;
  const SmoothForce& field = force->field;
  const Eigen::MatrixXd shapes = field.Shapes();
  const Eigen::Vector3d centroid = body.mesh.nodes * body.node_mass / body.node_mass.sum();
  const Eigen::Index count = static_cast<Eigen::Index>(motion.states.size());
  ForceHistory& history = force->history;
  history.times.resize(count);
  history.power.resize(count);
  for (Eigen::Matrix3Xd* rows :
       {&history.force, &history.force_deviation, &history.torque, &history.torque_deviation})
    rows->resize(3, count);

  Eigen::MatrixXd impulse_jacobian = Eigen::MatrixXd::Zero(3, field.amplitudes.size());
  Eigen::MatrixXd work_jacobian = Eigen::MatrixXd::Zero(1, field.amplitudes.size());
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero(), squares = impulse, variances = impulse;
  double duration = 0, work = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const TrajectoryState& state = motion.states[k];
    const Eigen::VectorXd amplitudes = field.AmplitudesAt(state.time);
    const Resultants resultants = ResultantsOf(shapes, state.position, centroid);
    const Eigen::MatrixXd power_jacobian = state.velocity.transpose() * shapes;
    const Eigen::MatrixXd force_jacobian = JacobianOverKnots(field, resultants.force, state.time);
    history.times[k] = state.time + motion.delay;
    history.force.col(k) = resultants.force * amplitudes;
    history.torque.col(k) = resultants.torque * amplitudes;
    history.power[k] = (power_jacobian * amplitudes)(0);
    history.force_deviation.col(k) = Deviations(force_jacobian, covariance);
    history.torque_deviation.col(k) =
        Deviations(JacobianOverKnots(field, resultants.torque, state.time), covariance);

    const double weight = TrapezoidalWeight(motion, k);
    duration += weight;
    impulse_jacobian += weight * force_jacobian;
    work_jacobian += weight * JacobianOverKnots(field, power_jacobian, state.time);
    impulse += weight * history.force.col(k);
    squares += weight * history.force.col(k).cwiseAbs2();
    variances += weight * history.force_deviation.col(k).cwiseAbs2();
    work += weight * history.power[k];
  }
  NetForceSummary& net = force->record.net;
  net.mean = impulse / duration;
  net.mean_deviation = Deviations(impulse_jacobian, covariance) / duration;
  net.rms = (squares / duration).cwiseSqrt();
  net.rms_deviation = (variances / duration).cwiseSqrt();
  if (net.rms.norm() > 0) net.constant_share = net.mean.norm() / net.rms.norm();
  force->record.work = {history.times[count - 1] - history.times[0], work,
                        Deviations(work_jacobian, covariance)[0], work / duration};
}

// Correlations of the force with the displacement, velocity and acceleration of the centre of mass
// of the moving part.
std::vector<ForceCorrelation> CorrelationsWithMotion(const Model& model,
                                                     const ReplayedMotion& motion,
                                                     const Eigen::VectorXd& moving_mass,
                                                     const Eigen::Matrix3Xd& force) {
  const Eigen::Index count = static_cast<Eigen::Index>(motion.states.size());
  const auto mean_over_mass = [&](const Eigen::VectorXd& nodal) -> Eigen::Vector3d {
    return nodal.reshaped(3, moving_mass.size()) * moving_mass / moving_mass.sum();
  };
  Eigen::Matrix3Xd displacement(3, count), velocity(3, count), acceleration(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const TrajectoryState& state = motion.states[k];
    displacement.col(k) = mean_over_mass(state.position - model.body->mesh.nodes.reshaped());
    velocity.col(k) = mean_over_mass(state.velocity);
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index a = std::max<Eigen::Index>(k - 1, 0), b = std::min(k + 1, count - 1);
    acceleration.col(k) =
        (velocity.col(b) - velocity.col(a)) / (motion.states[b].time - motion.states[a].time);
  }
  return {{"displacement", CorrelationOver(force, displacement)},
          {"velocity", CorrelationOver(force, velocity)},
          {"acceleration", CorrelationOver(force, acceleration)}};
}

void MeasurePlace(const Model& model, const ReplayedMotion& motion, UnexplainedForce* force) {
  const Body& body = *model.body;
  const std::vector<char> gripped = GrippedNodes(model);
  ForcePlace& place = force->record.place;
  const Eigen::Index count = static_cast<Eigen::Index>(motion.states.size());
  force->history.centroid = Eigen::Matrix3Xd::Zero(3, count);
  Eigen::VectorXd total = Eigen::VectorXd::Zero(body.NodeCount());
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd amount = force->field.DensityAt(motion.states[k].time)
                                       .colwise()
                                       .norm()
                                       .transpose()
                                       .cwiseProduct(body.node_mass);
    if (amount.sum() > 0) force->history.centroid.col(k) = body.mesh.nodes * amount / amount.sum();
    total += amount;
  }
  if (total.sum() > 0) place.centroid = body.mesh.nodes * total / total.sum();
  if (std::none_of(gripped.begin(), gripped.end(), [](char is) { return is != 0; })) return;
  const auto distance = [&](const Eigen::Vector3d& from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < body.mesh.nodes.cols(); ++i)
      if (gripped[i]) nearest = std::min(nearest, (body.mesh.nodes.col(i) - from).norm());
    return nearest;
  };
  place.grip_distance = distance(place.centroid);
  for (Eigen::Index i = 0; i < body.mesh.nodes.cols(); ++i)
    place.largest_grip_distance =
        std::max(place.largest_grip_distance, distance(body.mesh.nodes.col(i)));
}

// The thresholds are standard deviations of the force and the work, and the natural logarithm of a
// likelihood ratio. Larger: fewer forces that are only noise are reported, and fewer small forces
// that are real.
bool IsSignificant(const UnexplainedForceRecord& force) {
  constexpr double kClearForce = 2, kClearWork = 3, kClearEvidence = 5;
  if (!(force.fit.log_evidence > kClearEvidence)) return false;
  if (std::abs(force.work.work) > kClearWork * force.work.deviation) return true;
  const NetForceSummary& net = force.net;
  return (net.rms.array() > kClearForce * net.rms_deviation.array()).any() ||
         (net.mean.array().abs() > kClearForce * net.mean_deviation.array()).any();
}

}  // namespace

void MeasureForce(const Model& model, const ReplayedMotion& motion,
                  const Eigen::MatrixXd& covariance, UnexplainedForce* force) {
  const Eigen::VectorXd moving_mass = model.body->node_mass.cwiseProduct(force->field.modes.col(0));
  force->delay = motion.delay;
  force->record.net.weight = moving_mass.sum() * kStandardGravity;
  MeasureHistory(model, motion, covariance, force);
  force->record.correlations =
      CorrelationsWithMotion(model, motion, moving_mass, force->history.force);
  MeasurePlace(model, motion, force);
  force->record.fit.is_significant = IsSignificant(force->record);
}

}  // namespace lacuna
