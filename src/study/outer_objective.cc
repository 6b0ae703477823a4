#include "study/outer_objective.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>

#include "analysis/measure.h"
#include "core/error.h"
#include "effects/catalogue.h"
#include "geometry/surface_tracks.h"
#include "study/follow.h"
#include "study/reference.h"
#include "surface/repair.h"

namespace lacuna {
namespace {

// The study's elasticity law with other moduli.
std::shared_ptr<Effect> WithModuli(const Effect& material, double young_modulus,
                                   double poisson_ratio) {
  const EffectCard& card = material.Card();
  Eigen::VectorXd values = material.Parameters();
  for (size_t k = 0; k < card.parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (card.parameters[k].name == "young_modulus") values[i] = young_modulus;
    if (card.parameters[k].name == "poisson_ratio") values[i] = poisson_ratio;
  }
  const CatalogueEntry* entry = FindEntry(card.type);
  CHECK(entry != nullptr && entry->make != nullptr) << card.type;
  return entry->make(values);
}

ReferenceBody MakeTurnedBody(const OuterProblem& problem, const ReconstructionStudy& study) {
  TriMesh surface = problem.states.front().surface;
  if (problem.remesh_surface) {
    RemeshOptions options;
    options.edge_length = std::cbrt(6 * std::sqrt(2.0) * study.mesh.tets.max_volume);  // V = a³/6√2
    surface = RemeshIsotropic(surface, options);
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

// Mean length of D over the fixed sampling, frame k.
double MeanAtSamples(const OuterProblem& problem, const SurfaceTracks& samples,
                     const BoundarySurface& boundary, const FollowedFrame& frame, size_t k) {
  Eigen::Matrix3Xd residual(3, samples.Count());
  if (problem.registration_in_loop) {
    for (Eigen::Index j = 0; j < samples.Count(); ++j) {
      const auto corners = boundary.surface.triangles.col(samples.at_rest.triangle[j]);
      residual.col(j).setZero();
      for (int c = 0; c < 3; ++c) {
        residual.col(j) += samples.at_rest.barycentric(c, j) * frame.residual.col(corners[c]);
      }
    }
  } else {
    const Eigen::Matrix3Xd& at_rest = problem.tracked.points;
    residual = at_rest + problem.tracked.DisplacementAt(k, at_rest) -
               PointsAt(samples, boundary, frame.position);
  }
  return Summarise(residual.colwise().norm().transpose()).mean;
}

void Measure(const OuterProblem& problem, const FollowedMotion& motion, OuterEvaluation* result) {
  const BoundarySurface& boundary = motion.body->boundary;
  const SurfaceTracks samples = TrackOnSurface(boundary, problem.tracked.points);
  result->residual_sum = result->residual_per_point = result->scan_distance = result->force = 0;
  const auto frames = static_cast<double>(motion.frames.size() - 1);
  for (size_t k = 1; k < motion.frames.size(); ++k) {
    const FollowedFrame& frame = motion.frames[k];
    result->residual_sum += Summarise(frame.residual.colwise().norm().transpose()).sum;
    result->residual_per_point += MeanAtSamples(problem, samples, boundary, frame, k) / frames;
    result->scan_distance +=
        DistanceToSurface(BoundaryAt(boundary, frame.position), problem.states[k].cloud.points)
            .mean /
        frames;
    result->force += frame.force.rowwise().sum().norm() / frames;
  }
  result->usable = true;
}

void Evaluate(const OuterProblem& problem, const OuterParameters& parameters,
              OuterEvaluation* result) {
  ReconstructionStudy study = problem.study;
  study.mesh.tets.radius_edge_ratio = parameters.radius_edge_ratio;
  study.mesh.tets.max_volume = parameters.max_volume;
  study.mesh.tets.preserve_surface =
      problem.remesh_surface || problem.study.mesh.tets.preserve_surface;
  study.effects.front() =
      WithModuli(*study.effects.front(), parameters.young_modulus, parameters.poisson_ratio);
  const ReferenceBody reference = MakeTurnedBody(problem, study);
  result->nodes = static_cast<int>(reference.mesh.NodeCount());
  result->tets = static_cast<int>(reference.mesh.TetCount());
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  const FollowedMotion motion =
      FollowFrames(study, reference, problem.states, &progress,
                   problem.registration_in_loop ? nullptr : &problem.tracked);
  result->surface_points = static_cast<int>(motion.body->boundary.node.size());
  const FollowedFrame& last = motion.frames.back();
  if (!last.solver.usable) {
    result->failure =
        fmt::format("frame {}: {}", study.frames[motion.frames.size() - 1], last.solver.message);
    return;
  }
  Measure(problem, motion, result);
}

}  // namespace

OuterEvaluation EvaluateOuter(const OuterProblem& problem, const OuterParameters& parameters) {
  const auto begin = std::chrono::steady_clock::now();
  OuterEvaluation result;
  try {
    Evaluate(problem, parameters, &result);
  } catch (const InputError& refused) {
    result.failure = refused.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace lacuna
