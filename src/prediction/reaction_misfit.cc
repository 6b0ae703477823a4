#include "prediction/reaction_misfit.h"

#include <glog/logging.h>

namespace lacuna {
namespace {

// Whether the direction delays the time of reading `k`.
bool IsDelay(const MisfitDirection& direction, Eigen::Index k) {
  using Kind = MisfitDirection::Kind;
  return direction.kind == Kind::kClock ||
         (direction.kind == Kind::kCellDelay && direction.reading == static_cast<size_t>(k));
}

// The derivative of reaction `k` of the state with respect to each direction: 3 × directions, N per
// unit.
Eigen::Matrix3Xd ReactionDerivative(const std::vector<MisfitDirection>& directions, Eigen::Index k,
                                    const PredictedState& state, double start_time) {
  Eigen::Matrix3Xd derivative =
      Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(directions.size()));
  Eigen::Index of_model = 0;
  for (size_t d = 0; d < directions.size(); ++d) {
    auto column = derivative.col(static_cast<Eigen::Index>(d));
    if (directions[d].IsSimulated())
      column = state.reaction_jacobian.block<3, 1>(3 * k, of_model++);
    else if (IsDelay(directions[d], k) && state.time > start_time)
      column = -state.reaction_rate.segment<3>(3 * k);
  }
  return derivative;
}

}  // namespace

std::vector<Reaction> MeasuredReactions(const std::vector<MeasuredReaction>& readings,
                                        const Model& model) {
  std::vector<Reaction> reactions;
  for (const MeasuredReaction& reading : readings) {
    Reaction& wanted = reactions.emplace_back(Reaction{reading.held, std::nullopt});
    if (!reading.is_torque) continue;
    wanted.about = reading.about;
    if (!wanted.about)
      wanted.about =
          model.body->mesh.nodes(Eigen::all, model.grips[reading.held].nodes).rowwise().mean();
  }
  return reactions;
}

void AppendReaction(const std::vector<MeasuredReaction>& readings, size_t k, double time,
                    const PredictedState& state, double start_time,
                    const std::vector<MisfitDirection>& directions, ReactionMisfit* misfit) {
  const MeasuredReaction& reading = readings[k];
  const Eigen::Index own = static_cast<Eigen::Index>(k);
  const Eigen::Index row = misfit->residual.size();
  misfit->components = reading.Components();
  misfit->residual.conservativeResize(row + misfit->components);
  misfit->jacobian.conservativeResize(row + misfit->components,
                                      static_cast<Eigen::Index>(directions.size()));
  const bool covers = reading.Covers(time);
  misfit->count.insert(misfit->count.end(), static_cast<size_t>(misfit->components), covers);
  auto residual = misfit->residual.tail(misfit->components);
  auto jacobian = misfit->jacobian.bottomRows(misfit->components);
  residual.setZero();
  jacobian.setZero();
  if (!covers) return;
  residual = reading.directions.transpose() * state.reaction.segment<3>(3 * own) -
             ReadingAt(reading, time);
  jacobian =
      reading.directions.transpose() * ReactionDerivative(directions, own, state, start_time);
}

void ChooseSign(const MeasuredReaction& reading, const std::vector<double>& times,
                ReactionMisfit* misfit) {
  if (!reading.sign_is_unknown) return;
  Eigen::VectorXd opposite = misfit->residual;
  for (size_t f = 0; f < times.size(); ++f)
    if (reading.Covers(times[f]))
      opposite.segment(static_cast<Eigen::Index>(f) * misfit->components, misfit->components) +=
          2 * ReadingAt(reading, times[f]);
  const auto squares = [&](const Eigen::VectorXd& residual) {
    return Whitened(residual, misfit->count, misfit->components, ReadingErrors(reading))
        .squaredNorm();
  };
  if (squares(opposite) >= squares(misfit->residual)) return;
  misfit->residual = opposite;
  misfit->sign = -1;
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
