#include "prediction/compared_frame.h"

#include <utility>

namespace lacuna {
namespace {

// Rotates the vectors that are stacked in the columns of `stacked`.
template <typename Stacked>
void Turn(const Eigen::Matrix3d& turn, Stacked* stacked) {
  if (stacked->size() == 0) return;
  const Eigen::Matrix3Xd turned = turn * stacked->reshaped(3, stacked->size() / 3);
  *stacked = turned.reshaped(stacked->rows(), stacked->cols());
}

// The derivative of the nodes' positions by the clock, a load cell's delay or the registration,
// which follows from their motion without a tangent.
Eigen::VectorXd DerivativeWithoutSimulation(const RecordingModel& model,
                                            const MisfitDirection& direction,
                                            const Eigen::Isometry3d& registration,
                                            const NodalMotion& nodal) {
  if (direction.kind == MisfitDirection::Kind::kClock)
    return (nodal.moves ? -1.0 : 0.0) * nodal.velocity;
  if (direction.kind == MisfitDirection::Kind::kCellDelay)
    return Eigen::VectorXd::Zero(nodal.position.size());
  Eigen::Matrix3Xd rigid(3, nodal.position.size() / 3);
  for (Eigen::Index a = 0; a < rigid.cols(); ++a)
    rigid.col(a) =
        model.RegistrationDerivative(direction, registration, nodal.position.segment<3>(3 * a));
  return rigid.reshaped();
}

}  // namespace

void NodalMotion::Register(const Eigen::Isometry3d& registration) {
  Turn(registration.linear(), &position);
  position += registration.translation().replicate(position.size() / 3, 1);
  Turn(registration.linear(), &velocity);
  Turn(registration.linear(), &jacobian);
}

Misfit EmptyMisfit(const RecordingModel& model, size_t frames, size_t directions) {
  Misfit misfit;
  misfit.points = model.PointCount();
  misfit.reactions.resize(model.Reactions().size());
  misfit.residual.resize(model.observer().Components() * misfit.points *
                         static_cast<Eigen::Index>(frames));
  misfit.jacobian.setZero(misfit.residual.size(), static_cast<Eigen::Index>(directions));
  return misfit;
}

void AppendFrame(const RecordingModel& model, const std::vector<MisfitDirection>& directions,
                 const Eigen::Isometry3d& registration, int frame, const NodalMotion& nodal,
                 Observed seen, Misfit* misfit) {
  const Eigen::Index components = model.observer().Components();
  const Eigen::Index rows = components * misfit->points;
  const Eigen::Index begin = rows * static_cast<Eigen::Index>(misfit->frames.size());
  misfit->residual.segment(begin, rows) = *seen.rows * nodal.position - seen.target;
  Eigen::Index simulated = 0;
  for (size_t k = 0; k < directions.size(); ++k) {
    auto column = misfit->jacobian.col(static_cast<Eigen::Index>(k)).segment(begin, rows);
    if (directions[k].IsSimulated())
      column = *seen.rows * nodal.jacobian.col(simulated++);
    else
      column = *seen.rows * DerivativeWithoutSimulation(model, directions[k], registration, nodal);
  }
  for (int point = 0; point < misfit->points; ++point) {
    misfit->count.push_back(seen.count[point]);
    if (seen.count[point] > 0) continue;
    misfit->residual.segment(begin + components * point, components).setZero();
    misfit->jacobian.middleRows(begin + components * point, components).setZero();
  }
  misfit->deformation.insert(misfit->deformation.end(), seen.deformation.begin(),
                             seen.deformation.end());
  misfit->frames.push_back(frame);
  misfit->observed.push_back(std::move(seen));
}

}  // namespace lacuna
