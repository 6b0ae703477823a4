#include "reconstruction/reconstruction_measures.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/measure.h"
#include "core/atomic_file.h"
#include "core/median.h"
#include "experiment/frame_states.h"
#include "fit/force_model.h"
#include "geometry/embedding.h"
#include "geometry/finite_columns.h"
#include "geometry/nearest.h"
#include "reconstruction/known_answers.h"
#include "reconstruction/recorded_states.h"
#include "reconstruction/residual_at_vertices.h"
#include "record/csv_table.h"
#include "report/surface_picture.h"
#include "report/vtk_files.h"

namespace lacuna {
namespace {

size_t FirstFollowed(const ReconstructionStudy& study) {
  return FirstFrameIsReference(study) ? 1 : 0;
}

// The mean distance to the nearest other of these points, m; none if fewer than two are known.
std::optional<double> MeanSpacing(const Eigen::Matrix3Xd& first, const Eigen::Matrix3Xd& second) {
  Eigen::Matrix3Xd all(3, first.cols() + second.cols());
  all << first, second;
  const std::vector<Eigen::Index> known = FiniteColumns(all);
  if (known.size() < 2) return std::nullopt;
  const Eigen::Matrix3Xd points = all(Eigen::all, known);
  return PointSearch(points).Nearest(points, 2).distance.row(1).mean();
}

void MeasureHeldOut(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                    const FollowedMotion& motion, RunRecord* record) {
  const PlacesAtRest rest = FindPlacesAtRest(study, states);
  if (rest.held_out.cols() == 0) return;
  const Embedding places = Embed(motion.body->mesh, rest.held_out);
  double worst = 0;
  std::vector<char> compared(static_cast<size_t>(rest.held_out.cols()), 0);
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    if (!motion.frames[k].solver.usable) continue;
    const Eigen::VectorXd errors =
        (PointsAt(places, motion.body->mesh, motion.frames[k].position) - states[k].held_out)
            .colwise()
            .norm()
            .transpose();
    for (Eigen::Index j = 0; j < errors.size(); ++j)
      if (!std::isnan(errors[j])) compared[static_cast<size_t>(j)] = 1;
    worst = std::max(worst, Summarise(errors).rms);  // 0 if no point was compared
  }
  const auto points = std::count(compared.begin(), compared.end(), 1);
  record->measures["held_out_points"] = static_cast<double>(points);
  if (points == 0) return;
  record->measures["held_out_rms_max_m"] = worst;
  if (const auto spacing = MeanSpacing(rest.held_out, rest.tracked))
    record->measures["held_out_spacing_m"] = *spacing;
}

void MeasureTrueSurfaces(const ReconstructionStudy& study, const FollowedMotion& motion,
                         RunRecord* record) {
  if (study.validation.true_surfaces.empty()) return;
  double sum = 0, worst = 0;
  int followed = 0;
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    if (!motion.frames[k].solver.usable) continue;
    const TriMesh truth = ReadTrueSurface(study.validation, study.frames[k]);
    const TriMesh found = BoundaryAt(motion.body->boundary, motion.frames[k].position);
    const double mean = DistanceToSurface(found, truth.vertices).mean;
    sum += mean;
    worst = std::max(worst, mean);
    ++followed;
  }
  if (followed == 0) return;
  record->measures["true_surface_distance_mean_m"] = sum / followed;
  record->measures["true_surface_distance_max_m"] = worst;
}

void MeasureTruePositions(const ReconstructionStudy& study, const FollowedMotion& motion,
                          RunRecord* record) {
  if (study.validation.true_positions.empty()) return;
  const TruePositions known = ReadTruePositions(study.validation, study.frames);
  const Embedding embedding = Embed(motion.body->mesh, known.rest);
  double error_sum = 0, largest = 0;
  int64_t count = 0;
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    if (!motion.frames[k].solver.usable) continue;
    const Eigen::Matrix3Xd truth = known.At(study.frames[k]);
    const Eigen::Matrix3Xd found =
        known.rest + (PointsAt(embedding, motion.body->mesh, motion.frames[k].position) -
                      PointsAt(embedding, motion.body->mesh, motion.body->mesh.nodes));
    error_sum += (found - truth).colwise().norm().sum();
    largest = std::max(largest, (truth - known.rest).colwise().norm().maxCoeff());
    count += truth.cols();
  }
  if (count == 0) return;
  record->measures["true_position_mean_error_m"] = error_sum / static_cast<double>(count);
  record->measures["true_displacement_max_m"] = largest;
  if (largest > 0)
    record->measures["true_position_mean_error"] = error_sum / static_cast<double>(count) / largest;
}

void MeasureTrueForces(const ReconstructionStudy& study, const FollowedMotion& motion,
                       RunRecord* record) {
  if (study.validation.true_forces.empty()) return;
  const Eigen::MatrixXd truth = ReadTrueForces(study.validation, study.frames);
  std::vector<double> errors;
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    if (!motion.frames[k].solver.usable) continue;
    const Eigen::Vector3d known = truth.row(study.frames[k]).transpose();
    if (!(known.norm() > 0)) continue;
    errors.push_back((motion.frames[k].force.rowwise().sum() - known).norm() / known.norm());
  }
  if (errors.empty()) return;
  record->measures["true_force_median_error"] = Median(std::move(errors));
}

// Draws the model's surface at the last frame that was followed, coloured by |D|, with the scan's
// points.
void DrawLastFrame(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                   const FollowedMotion& motion, const ResidualAtVertices& residuals,
                   const std::filesystem::path& file) {
  size_t last = motion.frames.size();
  while (last > 0 && !motion.frames[last - 1].solver.usable) --last;
  if (last == 0) return;
  const FollowedFrame& frame = motion.frames[last - 1];
  SurfaceScene scene;
  scene.mesh = BoundaryAt(motion.body->boundary, frame.position);
  if (frame.residual_problem.empty()) {
    scene.vertex_values = 1e3 * residuals.Of(frame).colwise().norm().transpose();
    scene.value_name = "|D| mm";
  }
  scene.points = states[last - 1].cloud.points;
  scene.caption =
      fmt::format("{}, frame {}: model and scanned points", study.name, study.frames[last - 1]);
  PictureOptions options;
  options.show_edges = true;
  options.point_size = 2;
  const PictureResult picture = RenderSurfacePng(file, scene, options);
  if (!picture.IsUsable()) LOG(WARNING) << "no picture: " << picture.message;
}

double OrNotMeasured(bool measured, double value) { return measured ? value : kNotMeasured; }

// A sentence about followed frames in which D was not measured; empty where there is none.
std::string UnmeasuredWarning(const ReconstructionStudy& study, const FollowedMotion& motion) {
  int followed = 0, unmeasured = 0;
  std::string first;
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    if (!frame.solver.usable) continue;
    ++followed;
    if (frame.residual_problem.empty()) continue;
    if (unmeasured++ == 0)
      first = fmt::format("frame {}: {}", study.frames[k], frame.residual_problem);
  }
  if (unmeasured == 0) return "";
  return fmt::format(
      "|D| was not measured in {} of {} followed frames (the first is {}); means of |D| are over "
      "the other {}, and |D_anim|, a sum over all frames, is not given",
      unmeasured, followed, first, followed - unmeasured);
}

// Half of the tracked points farther from their places on the model than this: it does not follow
// them. The noise counts only where the distance is also a visible share of the object's size,
// since the errors of the mesh exceed a noise near 0.
constexpr double kManyDeviations = 30;
constexpr double kVisibleShare = 0.01;

// A sentence about frames in which fitted forces leave the model far from tracked points; empty
// where there is none. For scanned points, such a frame ends the motion (FarFromScan).
std::string FarFromTrackedWarning(const ReconstructionStudy& study,
                                  const std::vector<FrameState>& states,
                                  const FollowedMotion& motion, double size) {
  if (!study.follow.forces.AreFitted()) return "";
  const double least =
      std::min(kFarFromScan * size, std::max(kManyDeviations * motion.noise, kVisibleShare * size));
  int followed = 0, far = 0;
  double largest = 0;
  size_t worst = 0;
  for (size_t k = FirstFollowed(study); k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    if (!frame.solver.usable || states[k].tracked.cols() == 0) continue;
    ++followed;
    std::vector<double> distances;
    const Eigen::VectorXd lengths = frame.residual.colwise().norm().transpose();
    for (const double distance : lengths)
      if (!std::isnan(distance)) distances.push_back(distance);
    if (distances.empty()) continue;
    const double middle = Median(std::move(distances));
    if (middle <= least) continue;
    ++far;
    if (middle <= largest) continue;
    largest = middle;
    worst = k;
  }
  if (far == 0) return "";
  return fmt::format(
      "in {} of {} followed frames the model stays far from the tracked points: in frame {}, half "
      "of them are farther than {:.3g} mm from their places on the model, {:.0f} times the noise "
      "and {:.2g} % of the object's size. Likely causes are forces that cannot produce the motion "
      "(`region` and `force_scale` under `forces`), a wrong clamp, wrong `marker_places`, and "
      "points "
      "of another object",
      far, followed, study.frames[worst], 1e3 * largest, largest / motion.noise,
      100 * largest / size);
}

RunForces RunForcesOf(const ForceSettings& forces) {
  if (forces.AreFitted()) return RunForces::kFitted;
  return forces.kind == ForceSettings::Kind::kKnown ? RunForces::kKnown : RunForces::kNone;
}

}  // namespace

RunRecord MeasureRun(const ReconstructionStudy& study, const ReferenceBody& reference,
                     const std::vector<FrameState>& states, const FollowedMotion& motion) {
  RunRecord record;
  record.recording = study.recording.name;
  record.forces = RunForcesOf(study.follow.forces);
  record.frames_not_tried = static_cast<int>(states.size() - motion.frames.size());
  record.object_size = BoundingBoxDiagonal(motion.body->mesh.nodes);
  record.mesh = reference.quality;
  record.warnings = study.recording.warnings;
  const auto add = [&record](const std::vector<std::string>& warnings) {
    record.warnings.insert(record.warnings.end(), warnings.begin(), warnings.end());
  };
  add(WarningsOfStates(study, states));
  add(reference.notes);
  add(motion.warnings);
  const std::string unmeasured = UnmeasuredWarning(study, motion);
  if (!unmeasured.empty()) add({unmeasured});
  const std::string far = FarFromTrackedWarning(study, states, motion, record.object_size);
  if (!far.empty()) add({far});
  record.point_residuals.resize(motion.frames.front().residual.cols(),
                                static_cast<Eigen::Index>(motion.frames.size()));
  std::vector<LengthSummary> residuals;
  double distance_sum = 0, per_point_sum = 0;
  int followed = 0;
  for (size_t k = 0; k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    const bool usable = frame.solver.usable;
    const bool measured = usable && frame.residual_problem.empty();
    FrameRecord entry;
    entry.frame = study.frames[k];
    entry.time = frame.time;
    entry.solver = frame.solver;
    const LengthSummary residual = Summarise(frame.residual.colwise().norm().transpose());
    record.point_residuals.col(static_cast<Eigen::Index>(k)) = residual.lengths;
    if (usable) {
      const TriMesh surface = BoundaryAt(motion.body->boundary, frame.position);
      const LengthSummary distance = DistanceToSurface(surface, states[k].cloud.points);
      entry.surface_distance_mean = distance.mean;
      entry.surface_distance_rms = distance.rms;
      entry.surface_distance_max = distance.max;
      const Eigen::VectorXd force =
          Eigen::Map<const Eigen::VectorXd>(frame.force.data(), frame.force.size());
      const Eigen::VectorXd position =
          Eigen::Map<const Eigen::VectorXd>(frame.position.data(), frame.position.size());
      const Eigen::Vector3d centre =
          frame.position * motion.body->node_mass / motion.body->node_mass.sum();
      const NetForce net = NetForceOf(force, position, centre);
      entry.force_resultant = net.force;
      entry.force_resultant_deviation = frame.force_deviation;
      entry.torque_resultant = net.torque;
      if (k >= FirstFollowed(study)) {
        distance_sum += distance.mean;
        ++followed;
      }
    }
    if (measured && k >= FirstFollowed(study)) {
      residuals.push_back(residual);
      per_point_sum += residual.mean;
    }
    entry.residual = OrNotMeasured(measured, residual.sum);
    entry.residual_mean = OrNotMeasured(measured, residual.mean);
    entry.relative_residual = entry.residual_mean / record.object_size;
    entry.relative_surface_distance = entry.surface_distance_mean / record.object_size;
    record.frames.push_back(entry);
  }
  const auto measured_frames = static_cast<double>(residuals.size());
  const double per_point = OrNotMeasured(!residuals.empty(), per_point_sum / measured_frames);
  const bool complete = motion.frames.size() == states.size() && motion.frames.back().solver.usable;
  record.animation_residual =
      OrNotMeasured(complete && unmeasured.empty(), AnimationResidual(residuals));
  record.relative_animation_residual = per_point / record.object_size;
  if (!std::isnan(motion.noise)) record.measures["noise_m"] = motion.noise;
  record.measures["residual_frames"] = measured_frames;
  if (!residuals.empty()) record.measures["residual_per_point_m"] = per_point;
  if (followed > 0) record.measures["surface_distance_mean_m"] = distance_sum / followed;
  record.stages["forces"] = {complete, complete ? "converged" : "no convergence",
                             complete ? "" : motion.frames.back().solver.message, 0};
  MeasureHeldOut(study, states, motion, &record);
  MeasureTrueSurfaces(study, motion, &record);
  MeasureTruePositions(study, motion, &record);
  MeasureTrueForces(study, motion, &record);
  return record;
}

void WriteFields(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                 const FollowedMotion& motion, const std::filesystem::path& folder) {
  MakeFolder(folder / "fields");
  const Body& body = *motion.body;
  const ResidualAtVertices residuals(study, states, motion);
  std::vector<TimedFile> bodies, surfaces, scans;
  for (size_t k = 0; k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    if (!frame.solver.usable) continue;
    TetMesh deformed = body.mesh;
    deformed.nodes = frame.position;
    const auto file = [&](const char* what, const char* extension) {
      return folder / "fields" / fmt::format("{}_{:04}.{}", what, study.frames[k], extension);
    };
    WriteVtu(file("body", "vtu"), deformed,
             {{{"displacement_m", frame.position - body.mesh.nodes},
               {"force_N", frame.force},
               {"pseudo_force_N", frame.pseudo_force}},
              {}});
    bodies.push_back({frame.time, file("body", "vtu")});

    const TriMesh surface = BoundaryAt(body.boundary, frame.position);
    const Eigen::Matrix3Xd residual = residuals.Of(frame);
    WriteVtp(file("surface", "vtp"), surface,
             {{{"residual_m", residual}, {"residual_length_m", residual.colwise().norm()}}, {}});
    surfaces.push_back({frame.time, file("surface", "vtp")});

    const SurfaceHits hits = SurfaceSearch(surface).Nearest(states[k].cloud.points);
    WriteVtp(file("scan", "vtp"), states[k].cloud,
             {{"distance_to_model_m", hits.distance.transpose()}});
    scans.push_back({frame.time, file("scan", "vtp")});
  }
  DrawLastFrame(study, states, motion, residuals, folder / "last_frame.png");
  WritePvd(folder / "body.pvd", bodies);
  WritePvd(folder / "surface.pvd", surfaces);
  WritePvd(folder / "scan.pvd", scans);
}

}  // namespace lacuna
