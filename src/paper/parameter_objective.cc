#include "paper/parameter_objective.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/measure.h"
#include "core/error.h"
#include "effects/catalogue.h"
#include "geometry/surface_tracks.h"
#include "reconstruction/followed_sensitivity.h"
#include "reconstruction/recorded_states.h"
#include "surface/repair.h"

namespace lacuna {
namespace {

// Where y and p stand among the parameters of the elasticity law.
std::vector<int> ModuliOf(const EffectCard& card) {
  const std::vector<int> moduli = {ParameterIndex(card, "young_modulus"),
                                   ParameterIndex(card, "poisson_ratio")};
  CHECK(moduli[0] >= 0 && moduli[1] >= 0) << card.type;
  return moduli;
}

// The study's elasticity law with other moduli.
std::shared_ptr<const Effect> WithModuli(const Effect& material, double young_modulus,
                                         double poisson_ratio) {
  Eigen::VectorXd values = material.Parameters();
  const std::vector<int> moduli = ModuliOf(material.Card());
  values[moduli[0]] = young_modulus;
  values[moduli[1]] = poisson_ratio;
  return material.WithParameters(values);
}

ReferenceBody MakeTurnedBody(const ParameterObjective& problem, const ReconstructionStudy& study) {
  TriMesh surface = problem.states.front().surface;
  if (problem.remesh_surface) {
    // V = a³/6√2
    surface = RemeshIsotropic(surface, std::cbrt(6 * std::sqrt(2.0) * study.mesh.tets.max_volume));
  }
  const Eigen::Vector3d centre = surface.vertices.rowwise().mean();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(problem.turn, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  if (problem.turn != 0) {
    surface.vertices = (turn * (surface.vertices.colwise() - centre)).colwise() + centre;
  }
  ReferenceBody body = MakeReferenceBody({study.name, study.recording, study.mesh,
                                          study.sheet_layers, study.frames.front(), &surface});
  if (problem.turn != 0) {
    body.mesh.nodes = (turn.transpose() * (body.mesh.nodes.colwise() - centre)).colwise() + centre;
  }
  return body;
}

// D at the fixed sampling (3 × points, m), frame k.
Eigen::Matrix3Xd ResidualAtSamples(const ParameterObjective& problem, const SurfaceTracks& samples,
                                   const BoundarySurface& boundary, const FollowedFrame& frame,
                                   size_t k) {
  if (!problem.registration_in_loop) {
    const Eigen::Matrix3Xd& at_rest = problem.tracked.points;
    return at_rest + problem.tracked.DisplacementAt(k, at_rest) -
           PointsAt(samples, boundary, frame.position);
  }
  Eigen::Matrix3Xd residual = Eigen::Matrix3Xd::Zero(3, samples.Count());
  for (Eigen::Index j = 0; j < samples.Count(); ++j) {
    const auto corners = boundary.surface.triangles.col(samples.at_rest.triangle[j]);
    for (int c = 0; c < 3; ++c)
      residual.col(j) += samples.at_rest.barycentric(c, j) * frame.residual.col(corners[c]);
  }
  return residual;
}

// Σ_j ∂|D_j|/∂θ, or of |D_j|², where the points of D move by `moved` (3 × points) per unit of θ.
double SlopeOfLengths(const Eigen::Matrix3Xd& residual, const Eigen::Matrix3Xd& moved,
                      bool squared) {
  double slope = 0;
  for (Eigen::Index j = 0; j < residual.cols(); ++j) {
    const double length = residual.col(j).norm();
    const double along = -residual.col(j).dot(moved.col(j));
    if (squared) {
      slope += 2 * along;
    } else if (length > 0) {
      slope += along / length;
    }
  }
  return slope;
}

// Adds a frame's share; that of the root mean square is of the mean square as yet.
void AddSlopes(const BoundarySurface& boundary, const SurfaceTracks& samples,
               const FollowedFrame& frame, const Eigen::Matrix3Xd& at_samples, double frames,
               ObjectiveEvaluation* result) {
  const SurfaceTracks moving{samples.at_rest, Eigen::Matrix3Xd::Zero(3, samples.Count())};
  for (size_t i = 0; i < result->by_moduli.size(); ++i) {
    ObjectiveSlope& slope = result->by_moduli[i];
    const Eigen::Matrix3Xd nodes = frame.position_derivative.col(static_cast<Eigen::Index>(i))
                                       .reshaped(3, frame.position.cols());
    const double share = 1 / (frames * static_cast<double>(samples.Count()));
    const Eigen::Matrix3Xd moved = PointsAt(moving, boundary, nodes);
    slope.residual_per_point += share * SlopeOfLengths(at_samples, moved, false);
    slope.residual_rms += share * SlopeOfLengths(at_samples, moved, true);
    slope.residual_sum += SlopeOfLengths(frame.residual, nodes(Eigen::all, boundary.node), false);
  }
}

void Measure(const ParameterObjective& problem, const FollowedMotion& motion,
             ObjectiveEvaluation* result) {
  const BoundarySurface& boundary = motion.body->boundary;
  const SurfaceTracks samples = TrackOnSurface(boundary, problem.tracked.points);
  result->residual_sum = result->residual_per_point = result->scan_distance = result->force = 0;
  const auto frames = static_cast<double>(motion.frames.size() - 1);
  const bool differentiated = motion.frames.back().position_derivative.size() > 0;
  if (differentiated) result->by_moduli.assign(2, {0, 0, 0});
  double mean_square = 0;
  for (size_t k = 1; k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    const Eigen::Matrix3Xd residual = ResidualAtSamples(problem, samples, boundary, frame, k);
    const LengthSummary lengths = Summarise(residual.colwise().norm().transpose());
    result->residual_sum += Summarise(frame.residual.colwise().norm().transpose()).sum;
    result->residual_per_point += lengths.mean / frames;
    mean_square += lengths.rms * lengths.rms / frames;
    if (differentiated) AddSlopes(boundary, samples, frame, residual, frames, result);
    result->scan_distance +=
        DistanceToSurface(BoundaryAt(boundary, frame.position), problem.states[k].cloud.points)
            .mean /
        frames;
    result->force += frame.force.rowwise().sum().norm() / frames;
  }
  result->residual_rms = std::sqrt(mean_square);
  for (ObjectiveSlope& slope : result->by_moduli)
    slope.residual_rms /= 2 * std::max(result->residual_rms, 1e-300);
  const auto is_finite = [](const ObjectiveSlope& by) {
    return std::isfinite(by.residual_sum + by.residual_per_point + by.residual_rms);
  };
  if (!std::all_of(result->by_moduli.begin(), result->by_moduli.end(), is_finite))
    result->by_moduli.clear();
  result->usable = true;
}

ReconstructionStudy StudyAt(const ParameterObjective& problem,
                            const SearchedParameters& parameters) {
  ReconstructionStudy study = problem.study;
  study.mesh.tets.radius_edge_ratio = parameters.radius_edge_ratio;
  study.mesh.tets.max_volume = parameters.max_volume;
  study.mesh.tets.preserve_surface =
      problem.remesh_surface || problem.study.mesh.tets.preserve_surface;
  study.effects.front() =
      WithModuli(*study.effects.front(), parameters.young_modulus, parameters.poisson_ratio);
  return study;
}

}  // namespace

bool CanDifferentiate(const ParameterObjective& problem) {
  return !problem.registration_in_loop && HasModulusSensitivity(problem.study.follow.forces);
}

ReferenceBody MakeObjectiveBody(const ParameterObjective& problem,
                                const SearchedParameters& parameters) {
  return MakeTurnedBody(problem, StudyAt(problem, parameters));
}

FollowedMotion FollowForObjective(const ParameterObjective& problem,
                                  const SearchedParameters& parameters,
                                  const ReferenceBody& reference) {
  Progress progress({.style = ProgressStyle::kSilent});
  const ReconstructionStudy study = StudyAt(problem, parameters);
  return FollowFrames(study, reference, problem.states, &progress,
                      problem.registration_in_loop ? nullptr : &problem.tracked,
                      problem.slopes && CanDifferentiate(problem)
                          ? ModuliOf(study.effects.front()->Card())
                          : std::vector<int>());
}

ObjectiveEvaluation MeasureObjective(const ParameterObjective& problem,
                                     const FollowedMotion& motion) {
  ObjectiveEvaluation result;
  result.nodes = motion.body->NodeCount();
  result.tets = motion.body->ElementCount();
  result.surface_points = static_cast<int>(motion.body->boundary.node.size());
  const FollowedFrame& last = motion.frames.back();
  // A sum without the frames whose registration failed would be too small.
  const auto unmeasured =
      std::find_if(motion.frames.begin() + 1, motion.frames.end(),
                   [](const FollowedFrame& frame) { return !frame.residual_problem.empty(); });
  if (!last.solver.usable) {
    result.failure = fmt::format("frame {}: {}", problem.study.frames[motion.frames.size() - 1],
                                 last.solver.message);
  } else if (unmeasured != motion.frames.end()) {
    result.failure =
        fmt::format("frame {}: registration: {}",
                    problem.study.frames[static_cast<size_t>(unmeasured - motion.frames.begin())],
                    unmeasured->residual_problem);
  } else {
    Measure(problem, motion, &result);
  }
  return result;
}

ObjectiveEvaluation EvaluateObjective(const ParameterObjective& problem,
                                      const SearchedParameters& parameters) {
  const auto begin = std::chrono::steady_clock::now();
  ObjectiveEvaluation result;
  try {
    result = MeasureObjective(
        problem, FollowForObjective(problem, parameters, MakeObjectiveBody(problem, parameters)));
  } catch (const InputError& refused) {
    result.failure = refused.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace lacuna
