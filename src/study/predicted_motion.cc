#include "study/predicted_motion.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "analysis/residual_statistics.h"
#include "fem/prescribed_force.h"
#include "study/grip_tracks.h"
#include "study/outer_forces.h"

namespace lacuna {
namespace {

void MoveGripsWithMarkers(const Recording& recording, const std::vector<int>& frames,
                          const TetMesh& mesh, GripTracks* grips) {
  for (const int frame : frames)
    grips->Extend(recording.times[frame], mesh.nodes, mesh.nodes,
                  recording.markers.positions[frame]);
}

}  // namespace

RecordingModel::RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                               const TetMesh& mesh, std::shared_ptr<const Body> body)
    : study_(study), item_(recording) {
  model_.body = std::move(body);
  model_.effects = study.effects;
  model_.effects.insert(model_.effects.end(), recording.effects.begin(), recording.effects.end());
  GripTracks grips(recording.recording, mesh, &model_);
  MoveGripsWithMarkers(recording.recording, recording.frames, mesh, &grips);
  for (const auto& load : MakeKnownForces(recording.recording, model_))
    model_.effects.push_back(load);
  // The body has the elements of the mesh in an order of its own.
  places_ = Embed(model_.body->mesh, recording.recording.marker_places);

  if (item_.hold) {
    const std::string where = study.file.string() + ": hold of " + item_.name;
    const std::vector<int> nodes =
        NamingWhere(where, [&] { return SelectNodes(item_.hold->region, mesh.nodes); });
    const Eigen::VectorXi chosen =
        Eigen::Map<const Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
    const Eigen::VectorXd areas = NodeBoundaryAreas(*model_.body);
    if (areas(chosen).sum() == 0)
      throw InputError(where + " touches no boundary node: its region is too small");
    const Eigen::VectorXd share = BoundaryShares(*model_.body, chosen);
    const double weight = 10 * model_.body->node_mass.sum();  // N, about that of the object
    for (int axis = 0; axis < 3; ++axis) {
      Nuisance nuisance;
      nuisance.prior.name = fmt::format("{}.hold_force_{}", item_.name, "xyz"[axis]);
      nuisance.prior.prior_deviation = nuisance.prior.typical = weight;
      Eigen::VectorXd& force = nuisance.direction.perturbation.held_force;
      force = Eigen::VectorXd::Zero(3 * share.size());
      for (Eigen::Index i = 0; i < share.size(); ++i) force[3 * i + axis] = share[i];
      nuisances_.push_back(std::move(nuisance));
    }
  }
  if (item_.clock_deviation > 0) {
    Nuisance nuisance;
    nuisance.prior.name = item_.name + ".clock";
    nuisance.prior.prior_deviation = nuisance.prior.typical = item_.clock_deviation;
    nuisance.direction.is_clock = true;
    nuisances_.push_back(std::move(nuisance));
  }
}

std::vector<int> RecordingModel::FittedFrames() const {
  std::vector<int> frames;
  if (!item_.fitted) return frames;
  for (const int frame : item_.frames)
    if (item_.recording.times[frame] <= item_.fit_until) frames.push_back(frame);
  return frames;
}

PredictionOptions RecordingModel::Options(const Eigen::VectorXd& nuisance) const {
  CHECK_EQ(nuisance.size(), static_cast<Eigen::Index>(nuisances_.size()));
  PredictionOptions options;
  options.start_time = item_.StartTime();
  options.time_step = study_.time_step;
  options.step.scheme = study_.scheme;
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
    if (nuisances_[k].direction.is_clock) late += nuisance[static_cast<Eigen::Index>(k)];
  return late;
}

Misfit RecordingModel::Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                               const std::vector<MisfitDirection>& directions) const {
  const Body& body = *model_.body;
  const int markers = MarkerCount();
  const PredictionOptions options = Options(nuisance);
  const double late = Delay(nuisance);
  std::vector<double> times;
  for (const int frame : frames) times.push_back(item_.recording.times[frame] - late);

  // The clock needs no tangent: a later clock sees the motion earlier.
  std::vector<Perturbation> perturbations;
  std::vector<Eigen::Index> column;
  for (const MisfitDirection& direction : directions) {
    column.push_back(direction.is_clock ? -1 : static_cast<Eigen::Index>(perturbations.size()));
    if (!direction.is_clock) perturbations.push_back(direction.perturbation);
  }

  Misfit misfit;
  const Eigen::Index rows_of_frame = 3 * markers;
  misfit.residual.resize(rows_of_frame * static_cast<Eigen::Index>(frames.size()));
  misfit.by.setZero(misfit.residual.size(), static_cast<Eigen::Index>(directions.size()));
  misfit.summary = lacuna::Predict(
      model_, options, times, perturbations, [&](int index, const PredictedState& state) {
        const int frame = frames[index];
        const Eigen::Index begin = rows_of_frame * index;
        const Eigen::Matrix3Xd& measured = item_.recording.markers.positions[frame];
        const Eigen::VectorXd predicted = AtMarkers(places_, body.mesh, state.position);
        const Eigen::VectorXd velocity = AtMarkers(places_, body.mesh, state.velocity);
        Eigen::MatrixXd by;
        if (!perturbations.empty()) by = AtMarkers(places_, body.mesh, state.position_by);
        for (int m = 0; m < markers; ++m) {
          const bool observed = measured.col(m).allFinite();
          misfit.observed.push_back(observed);
          const Eigen::Index row = begin + 3 * m;
          misfit.residual.segment<3>(row).setZero();
          if (!observed) continue;
          misfit.residual.segment<3>(row) = predicted.segment<3>(3 * m) - measured.col(m);
          for (size_t k = 0; k < directions.size(); ++k) {
            const Eigen::Index at = static_cast<Eigen::Index>(k);
            const bool moves = state.time > options.start_time;
            if (column[k] >= 0) {
              misfit.by.col(at).segment<3>(row) = by.col(column[k]).segment<3>(3 * m);
            } else if (moves) {
              misfit.by.col(at).segment<3>(row) = -velocity.segment<3>(3 * m);
            }
          }
        }
        misfit.frames.push_back(frame);
      });
  const Eigen::Index reached = rows_of_frame * static_cast<Eigen::Index>(misfit.frames.size());
  misfit.residual.conservativeResize(reached);
  misfit.by.conservativeResize(reached, Eigen::NoChange);
  return misfit;
}

Eigen::MatrixXd AtMarkers(const Embedding& places, const TetMesh& mesh,
                          const Eigen::MatrixXd& nodal) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * places.tet.size(), nodal.cols());
  for (Eigen::Index m = 0; m < places.tet.size(); ++m)
    for (Eigen::Index a = 0; a < places.weight.rows(); ++a)
      rows.middleRows<3>(3 * m) +=
          places.weight(a, m) * nodal.middleRows<3>(3 * mesh.tets(a, places.tet[m]));
  return rows;
}

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<char>& observed,
                         int markers, double noise, double place_deviation) {
  CHECK_GT(noise, 0);
  Eigen::MatrixXd white = rows / noise;
  const Eigen::Index frames = rows.rows() / (3 * markers);
  const double ratio = place_deviation / noise;
  for (int m = 0; m < markers; ++m) {
    double seen = 0;
    for (Eigen::Index f = 0; f < frames; ++f) seen += observed[f * markers + m];
    if (seen == 0) continue;
    // (σ² I + s² 1 1ᵀ)^(−1/2) takes this share of the mean away.
    const double share = 1 - 1 / std::sqrt(1 + seen * ratio * ratio);
    for (int axis = 0; axis < 3; ++axis) {
      for (Eigen::Index k = 0; k < rows.cols(); ++k) {
        double mean = 0;
        for (Eigen::Index f = 0; f < frames; ++f) mean += white(3 * (f * markers + m) + axis, k);
        mean /= seen;
        for (Eigen::Index f = 0; f < frames; ++f)
          if (observed[f * markers + m]) white(3 * (f * markers + m) + axis, k) -= share * mean;
      }
    }
  }
  return white;
}

double EstimateMarkerNoise(const PredictedRecording& item, const std::vector<int>& frames) {
  Eigen::MatrixXd rows(item.recording.marker_places.size(),
                       static_cast<Eigen::Index>(frames.size()));
  for (size_t k = 0; k < frames.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) = item.recording.markers.positions[frames[k]].reshaped();
  const double noise = WhiteNoise(rows);
  return std::isnan(noise) ? 0 : noise;
}

}  // namespace lacuna
