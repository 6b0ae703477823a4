#include "diagnosis/plane_proposals.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "diagnosis/thresholds.h"
#include "effects/gravity.h"
#include "fem/prediction.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kNowhere = -std::numeric_limits<double>::infinity();

// Predicted minus measured positions of one recording: 3 × (points·frames), frames outermost; NaN
// where a point was not observed. The errors of the points' `places` on the object are removed.
Eigen::Matrix3Xd Displacements(const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part,
                               const Eigen::MatrixXd& places) {
  const Eigen::Index frames = static_cast<Eigen::Index>(part.observed.size());
  const Eigen::Index points = part.observed.front().count.size();
  const Eigen::Index components = part.layout.series / points;
  const Eigen::VectorXd residual = misfit.residual.segment(part.first_row, part.layout.Rows());
  Eigen::Matrix3Xd displacements =
      Eigen::Matrix3Xd::Constant(3, points * frames, std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Observed& seen = part.observed[static_cast<size_t>(f)];
    for (Eigen::Index i = 0; i < points; ++i) {
      if (seen.count[i] == 0) continue;
      Eigen::VectorXd own = residual.segment(components * (f * points + i), components);
      if (part.layout.deformation.empty())
        own -= places.col(i);
      else
        own -= part.layout.deformation[static_cast<size_t>(f * points + i)] * places.col(i);
      if (components == 3)
        displacements.col(f * points + i) = own;
      else
        displacements.col(f * points + i) = own[0] * seen.normal.col(i);
    }
  }
  return displacements;
}

// The errors of the places of each part's points, components × points: what is the same in all
// frames that show a point, of all recordings with its marker.
std::vector<Eigen::MatrixXd> PlaceErrorsOf(const std::vector<const LinearisedMisfit::Part*>& parts,
                                           const LinearisedMisfit& misfit,
                                           const CalibrationProblem& problem) {
  const auto residual = [&](const LinearisedMisfit::Part& part) -> Eigen::VectorXd {
    return misfit.residual.segment(part.first_row, part.layout.Rows());
  };
  const auto counts = [](const LinearisedMisfit::Part& part) {
    std::vector<double> count;
    for (const Observed& seen : part.observed)
      count.insert(count.end(), seen.count.begin(), seen.count.end());
    return count;
  };
  const auto all_frames = [](const LinearisedMisfit::Part& part) {
    return std::vector<char>(part.observed.size(), 1);
  };
  CommonErrors of_markers = problem.NoPlaceErrors().errors;
  for (const LinearisedMisfit::Part* part : parts)
    if (!part->layout.offset_ids.empty())
      of_markers.Add(residual(*part), counts(*part), part->errors, all_frames(*part),
                     part->layout.deformation, part->layout.offset_ids);
  const Eigen::MatrixXd common = of_markers.Mean();
  std::vector<Eigen::MatrixXd> places;
  for (const LinearisedMisfit::Part* part : parts)
    if (!part->layout.offset_ids.empty())
      places.emplace_back(common(Eigen::all, part->layout.offset_ids));
    else
      places.push_back(CommonError(residual(*part), counts(*part),
                                   static_cast<int>(part->observed.front().count.size()),
                                   part->errors, all_frames(*part)));
  return places;
}

// How far the predicted body and the object reach in some directions.
struct Reach {
  Eigen::MatrixXd directions;  // 3 × n, unit
  Eigen::VectorXd model, object;

  explicit Reach(Eigen::MatrixXd unit_directions)
      : directions(std::move(unit_directions)),
        model(Eigen::VectorXd::Constant(directions.cols(), kNowhere)),
        object(model) {}
  void Add(const Eigen::Vector3d& predicted, const Eigen::Vector3d& displacement) {
    model = model.cwiseMax(directions.transpose() * predicted);
    object = object.cwiseMax(directions.transpose() * (predicted - displacement));
  }
};

Eigen::MatrixXd DirectionsToTry(const PredictionStudy& study,
                                const Eigen::Vector3d& largest_misfit) {
  std::vector<Eigen::Vector3d> directions;
  const auto add = [&](const Eigen::Vector3d& direction) {
    const double length = direction.norm();
    if (length == 0) return;
    const bool known =
        std::any_of(directions.begin(), directions.end(), [&](const Eigen::Vector3d& other) {
          return other.dot(direction) > kThresholds.pilots.same_direction_cosine * length;
        });
    if (!known) directions.emplace_back(direction / length);
  };
  for (const double sign : {1.0, -1.0})
    for (int axis = 0; axis < 3; ++axis) add(sign * Eigen::Vector3d::Unit(axis));
  if (const std::optional<Eigen::Vector3d> gravity = GravityOf(study.effects)) {
    add(*gravity);
    add(-*gravity);
  }
  add(largest_misfit);
  Eigen::MatrixXd all(3, static_cast<Eigen::Index>(directions.size()));
  for (size_t k = 0; k < directions.size(); ++k)
    all.col(static_cast<Eigen::Index>(k)) = directions[k];
  return all;
}

// For each node the measured point that is nearest at rest, among those that a frame shows.
class NearestPoints {
 public:
  // `nodes` and `points`: positions at rest, m.
  NearestPoints(Eigen::Matrix3Xd nodes, Eigen::Matrix3Xd points)
      : nodes_(std::move(nodes)), points_(std::move(points)) {}

  // The nearest points of a frame with these displacements (3 × points, NaN where a point was not
  // observed); nothing if none was observed. Valid until the next call.
  const Eigen::RowVectorXi& In(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements) {
    std::vector<int> observed;
    for (Eigen::Index point = 0; point < points_.cols(); ++point)
      if (!displacements.col(point).hasNaN()) observed.push_back(static_cast<int>(point));
    if (observed == observed_) return nearest_;
    observed_ = std::move(observed);
    nearest_.resize(0);
    if (observed_.empty()) return nearest_;
    nearest_ = PointSearch(points_(Eigen::all, observed_)).Nearest(nodes_).index.row(0);
    for (int& point : nearest_) point = observed_[static_cast<size_t>(point)];
    return nearest_;
  }

 private:
  const Eigen::Matrix3Xd nodes_, points_;
  std::vector<int> observed_;  // those among which nearest_ was found
  Eigen::RowVectorXi nearest_;
};

void AddBody(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
             const Eigen::Matrix3Xd& displacements, Reach* reach) {
  const Model& model = recording.model();
  const std::vector<char> gripped = GrippedNodes(model);
  std::vector<int> nodes;
  for (const int node : model.body->boundary.node)
    if (!gripped[static_cast<size_t>(node)]) nodes.push_back(node);
  NearestPoints near(model.body->mesh.nodes(Eigen::all, nodes), recording.observer().Places());
  const Eigen::Index points = recording.PointCount();
  std::vector<double> times;
  for (const int frame : recording.recording().frames)
    times.push_back(recording.FrameTime(frame) - recording.Delay(nuisance));
  const Model placed = recording.PlacedModel(nuisance);
  const PredictionSummary summary = Predict(
      placed, recording.Options(nuisance), times, {}, [&](int frame, const PredictedState& state) {
        const auto seen = displacements.middleCols(frame * points, points);
        const Eigen::RowVectorXi& nearest = near.In(seen);
        for (Eigen::Index k = 0; k < nearest.size(); ++k)
          reach->Add(state.position.segment<3>(3 * nodes[static_cast<size_t>(k)]),
                     seen.col(nearest[k]));
      });
  CHECK(summary.IsUsable()) << "the fitted model could be predicted before, but not now: "
                            << summary.message;
}

}  // namespace

std::vector<ProposedPlane> ProposePlanes(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit) {
  std::vector<const LinearisedMisfit::Part*> parts;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    if (part.IsOfPoints()) parts.push_back(&part);
  std::vector<Eigen::Matrix3Xd> displacements;
  Eigen::Vector3d largest = Eigen::Vector3d::Zero();
  double noise = 0;
  const std::vector<Eigen::MatrixXd> places = PlaceErrorsOf(parts, misfit, problem);
  for (size_t p = 0; p < parts.size(); ++p) {
    displacements.push_back(Displacements(misfit, *parts[p], places[p]));
    noise = std::max(noise, parts[p]->errors.noise);
    for (const auto& displacement : displacements.back().colwise())
      if (displacement.norm() > largest.norm()) largest = displacement;
  }

  // The expected maximum of that many Gaussian errors.
  const double significant =
      noise * std::sqrt(2 * std::log(static_cast<double>(misfit.residual.size()) + 1));

  // A direction in which not even the measured points cross needs no simulation.
  Reach of_points(DirectionsToTry(problem.study(), largest));
  for (size_t p = 0; p < parts.size(); ++p) {
    Eigen::Index column = 0;
    for (const Observed& seen : parts[p]->observed)
      for (Eigen::Index i = 0; i < seen.count.size(); ++i, ++column)
        if (seen.count[i] > 0)
          of_points.Add(seen.measured.col(i) + displacements[p].col(column),
                        displacements[p].col(column));
  }
  std::vector<int> crossed;
  for (Eigen::Index k = 0; k < of_points.directions.cols(); ++k)
    if (of_points.model[k] - of_points.object[k] > significant)
      crossed.push_back(static_cast<int>(k));
  std::vector<ProposedPlane> planes;
  if (crossed.empty()) return planes;

  Reach of_body(of_points.directions(Eigen::all, crossed));
  for (size_t p = 0; p < parts.size(); ++p) {
    const size_t recording = parts[p]->recording;
    AddBody(problem.ModelAt(recording, values), problem.NuisanceOf(recording, values),
            displacements[p], &of_body);
  }
  for (Eigen::Index k = 0; k < of_body.directions.cols(); ++k) {
    const double crossing = of_body.model[k] - of_body.object[k];
    if (crossing > significant)
      planes.push_back({-of_body.directions.col(k), -of_body.object[k], crossing});
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const auto& a, const auto& b) { return a.crossing > b.crossing; });
  return planes;
}

}  // namespace lacuna
