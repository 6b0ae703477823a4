#include "prediction/reaction_misfit.h"

#include <glog/logging.h>

namespace lacuna {
namespace {

// The derivative of reaction `k` of the state by each direction: 3 × directions, N per unit.
Eigen::Matrix3Xd ReactionBy(const std::vector<MisfitDirection>& directions, Eigen::Index k,
                            const PredictedState& state, double start_time) {
  Eigen::Matrix3Xd by = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(directions.size()));
  Eigen::Index of_model = 0;
  for (size_t d = 0; d < directions.size(); ++d) {
    auto column = by.col(static_cast<Eigen::Index>(d));
    if (directions[d].kind == MisfitDirection::Kind::kModel)
      column = state.reaction_jacobian.block<3, 1>(3 * k, of_model++);
    else if (directions[d].kind == MisfitDirection::Kind::kClock && state.time > start_time)
      column = -state.reaction_rate.segment<3>(3 * k);
  }
  return by;
}

}  // namespace

std::vector<size_t> MeasuredGrips(const std::vector<MeasuredReaction>& readings) {
  std::vector<size_t> grips;
  for (const MeasuredReaction& reading : readings) grips.push_back(reading.held);
  return grips;
}

void AppendReactions(const std::vector<MeasuredReaction>& readings, double time,
                     const PredictedState& state, double start_time,
                     const std::vector<MisfitDirection>& directions,
                     std::vector<ReactionMisfit>* misfits) {
  misfits->resize(readings.size());
  for (size_t k = 0; k < readings.size(); ++k) {
    const MeasuredReaction& reading = readings[k];
    ReactionMisfit& misfit = (*misfits)[k];
    const Eigen::Index own = static_cast<Eigen::Index>(k);
    const Eigen::Index row = misfit.residual.size();
    misfit.components = reading.Components();
    misfit.residual.conservativeResize(row + misfit.components);
    misfit.jacobian.conservativeResize(row + misfit.components,
                                       static_cast<Eigen::Index>(directions.size()));
    const bool covers = reading.Covers(time);
    misfit.count.insert(misfit.count.end(), static_cast<size_t>(misfit.components), covers);
    auto residual = misfit.residual.tail(misfit.components);
    auto jacobian = misfit.jacobian.bottomRows(misfit.components);
    residual.setZero();
    jacobian.setZero();
    if (!covers) continue;
    residual = reading.directions.transpose() * state.reaction.segment<3>(3 * own) -
               ReadingAt(reading, time);
    jacobian = reading.directions.transpose() * ReactionBy(directions, own, state, start_time);
  }
}

MeasurementErrors ReadingErrors(const MeasuredReaction& reading) {
  CHECK_GT(reading.deviation, 0);
  return {reading.deviation, reading.tare_deviation};
}

Eigen::VectorXd TareOf(const ReactionMisfit& misfit, const MeasuredReaction& reading,
                       const std::vector<char>& among) {
  return CommonError(misfit.residual, misfit.count, misfit.components, ReadingErrors(reading),
                     among)
      .transpose();
}

}  // namespace lacuna
