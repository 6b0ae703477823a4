#include "diagnosis/nuisance_candidates.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/linear_misfit.h"
#include "calibration/mesh_limit.h"

namespace lacuna {
namespace {

// How well the object's dimensions are known, in parts of them: 0.05 mm of 17 mm.
constexpr double kShape = 0.003;
// By a tenth of which they are changed to see what that does: a longer motion parts in phase.
constexpr double kShapeProbe = 0.1;
// By how much frames may be mistimed, in parts of their distance.
constexpr double kJitter = 0.1;
// What refining elements without end changes, in parts of what a finer mesh does, is known to what
// it exceeds 1 by, and no better than this.
constexpr double kLimitDeviation = 0.4;
// A mesh between the two tells how well that is known. Of a bar of 160 to 190 elements, whose error
// stands at 70 to 95 σ over all rows, a sixth of the volume leaves 8 to 14 σ in other directions
// than its own, a twelfth 2 to 5 σ: this part of what the last halving changes there. It would do
// the work of a missing effect: a mesh that is a little too stiff near the clamp looks like a
// stiffness that falls along the bar.
constexpr double kUnknownOfMesh = 0.4;
// Of steps, what two halvings change gives the limit of a method of the scheme's order (Richardson,
// Phil. Trans. A 210, 1911): known to this, and to this part of what the two differ by from such a
// method. Of ten bars, in steps of second order, a sixteenth of the step was off that limit by 0.1
// of it, and by 0.6 in two that ring in modes which no step resolves.
constexpr LinearPrior kStepLimit = {1, 0.05, false};
constexpr double kUnknownOfStep = 0.7;

// One column of rows that are marker coordinates.
Eigen::VectorXd FrameColumn(const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part,
                            const std::function<double(Eigen::Index frame, int series)>& value) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(misfit.residual.size());
  for (Eigen::Index f = 0; f < static_cast<Eigen::Index>(part.layout.times.size()); ++f)
    for (int s = 0; s < part.layout.series; ++s)
      column[part.first_row + f * part.layout.series + s] = value(f, s);
  return column;
}

std::optional<NuisanceCandidate> MeshNuisance(const CalibrationProblem& problem,
                                              const Eigen::VectorXd& values,
                                              const LinearisedMisfit& misfit) {
  const std::optional<FinerMesh> finer =
      MakeFinerMesh(problem, values, misfit, /*fitted_only=*/false);
  if (!finer) return std::nullopt;
  const PredictionStudy study = problem.WithEstimatedNoise();
  const auto residual = [&](const CalibrationProblem& with_part, double ratio) {
    const Eigen::VectorXd change = finer->ToRatio(ratio) * finer->change;
    return with_part.Linearise(MovedBy(problem.parameters(), values, change), false).residual;
  };
  const auto half_way = WithFinerElements(study, finer->ratio / 2);
  if (half_way == nullptr) return std::nullopt;
  const Eigen::VectorXd fine = residual(CalibrationProblem(study, finer->mesh), finer->ratio);
  const Eigen::VectorXd between = residual(*half_way, finer->ratio / 2);
  if (fine.size() != misfit.residual.size() || between.size() != fine.size()) return std::nullopt;
  NuisanceCandidate candidate{"mesh", "the size of the elements",
                              "choose a smaller mesh.max_volume"};
  candidate.by.resize(fine.size(), 2);
  candidate.by << fine - misfit.residual, fine - between;
  const double limit = finer->ToLimit();
  candidate.priors = {{limit, std::max(kLimitDeviation, limit - 1), false},
                      {0, kUnknownOfMesh, false}};
  candidate.is_always_taken = true;
  candidate.unknown = kUnknownOfMesh * candidate.by.col(1);
  return candidate;
}

// How many times smaller the next halving's change is. Where the scheme promises less than second
// order, effects that remember may still have it: the observed order (Roache, Verification and
// Validation in Computational Science and Engineering, 1998), within what there is.
double ChangeOfHalving(TimeScheme scheme, const Eigen::VectorXd& whole, const Eigen::VectorXd& half,
                       const Eigen::VectorXd& quarter) {
  constexpr double kSecondOrder = 4;
  const double least = std::exp2(OrderOf(scheme));
  const double along = (half - whole).dot(quarter - half);
  if (!(along > 0)) return least;
  return std::clamp((half - whole).squaredNorm() / along, least, kSecondOrder);
}

std::optional<NuisanceCandidate> StepNuisance(const CalibrationProblem& problem,
                                              const Eigen::VectorXd& values,
                                              const LinearisedMisfit& misfit) {
  const auto with_steps = [&](double ratio) {
    PredictionStudy slow = problem.WithEstimatedNoise();
    slow.time_step /= ratio;
    return CalibrationProblem(slow, problem.body()->mesh).Linearise(values, false).residual;
  };
  const Eigen::VectorXd half = with_steps(2), quarter = with_steps(4);
  if (half.size() != misfit.residual.size() || quarter.size() != half.size()) return std::nullopt;
  NuisanceCandidate candidate{kTimeStepNuisance, "the length of the step",
                              "choose a smaller motion.time_step"};
  candidate.by.resize(half.size(), 2);
  const double power = ChangeOfHalving(problem.study().scheme, misfit.residual, half, quarter);
  candidate.by << quarter + (quarter - half) / (power - 1) - misfit.residual,
      (quarter - half) - (half - misfit.residual) / power;
  candidate.priors = {kStepLimit, {0, kUnknownOfStep, false}};
  candidate.is_always_taken = true;
  candidate.unknown = kUnknownOfStep * candidate.by.col(1);
  return candidate;
}

std::optional<NuisanceCandidate> ShapeNuisance(const CalibrationProblem& problem,
                                               const Eigen::VectorXd& values,
                                               const LinearisedMisfit& misfit) {
  const Model& model = problem.models().front().model();
  const TetMesh& mesh = problem.body()->mesh;
  // What is gripped at a face stays at it.
  Eigen::Vector3d centre = mesh.nodes.rowwise().mean();
  if (!model.grips.empty() && model.grips.front().nodes.size() > 0)
    centre = mesh.nodes(Eigen::all, model.grips.front().nodes).rowwise().mean();
  const PredictionStudy study = problem.WithEstimatedNoise();
  NuisanceCandidate candidate{"shape", "the object's dimensions", "measure the object again"};
  candidate.by = Eigen::MatrixXd::Zero(misfit.residual.size(), 3);
  candidate.is_always_taken = true;
  for (int axis = 0; axis < 3; ++axis) {
    TetMesh larger = mesh;
    larger.nodes.row(axis).array() +=
        kShapeProbe * kShape * (mesh.nodes.row(axis).array() - centre[axis]);
    const LinearisedMisfit changed = CalibrationProblem(study, larger).Linearise(values, false);
    if (!changed.usable || changed.residual.size() != misfit.residual.size()) return std::nullopt;
    candidate.by.col(axis) = (changed.residual - misfit.residual) / kShapeProbe;
    candidate.priors.push_back({0, 1, false});
  }
  return candidate;
}

}  // namespace

std::vector<NuisanceCandidate> NuisancesAlwaysTaken(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values,
                                                    const LinearisedMisfit& misfit) {
  std::vector<NuisanceCandidate> all;
  for (const auto& make : {MeshNuisance, StepNuisance, ShapeNuisance})
    if (std::optional<NuisanceCandidate> candidate = make(problem, values, misfit))
      all.push_back(*std::move(candidate));
  return all;
}

std::vector<NuisanceCandidate> MeasurementNuisances(const CalibrationProblem& problem,
                                                    const LinearisedMisfit& misfit,
                                                    const Eigen::VectorXd& left) {
  std::vector<NuisanceCandidate> candidates;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const PredictedRecording& item = problem.models()[part.recording].item();
    const std::vector<double>& times = part.layout.times;
    const Eigen::Index frames = static_cast<Eigen::Index>(times.size());
    if (frames < 3) continue;
    const double spacing = (times.back() - times.front()) / static_cast<double>(frames - 1);
    const auto speed = [&](Eigen::Index f, int s) {
      return part.speed[f * part.layout.series + s];
    };
    if (item.clock_deviation == 0) {
      NuisanceCandidate clock{"clock", "the clock of " + item.name,      "give clock_deviation",
                              0,       FrameColumn(misfit, part, speed), {{0, spacing, false}}};
      candidates.push_back(std::move(clock));
    }
    if (times.size() <= kMostFramesEach) {
      NuisanceCandidate jitter{"time_jitter",
                               "the times of single frames of " + item.name,
                               "check the camera's clock and its exposure",
                               0,
                               {},
                               {}};
      jitter.is_of_single_frames = true;
      jitter.by.resize(misfit.residual.size(), frames);
      for (Eigen::Index frame = 0; frame < frames; ++frame) {
        jitter.by.col(frame) = FrameColumn(
            misfit, part, [&](Eigen::Index f, int s) { return f == frame ? speed(f, s) : 0.0; });
        jitter.priors.push_back({0, kJitter * spacing, false});
      }
      candidates.push_back(std::move(jitter));
    }

    Eigen::Index worst = 0;
    double most = -1;
    for (Eigen::Index f = 0; f < frames; ++f) {
      const double square =
          left.segment(part.first_row + f * part.layout.series, part.layout.series).squaredNorm();
      if (square > most) {
        most = square;
        worst = f;
      }
    }
    // Of what the frame shows, about the object's middle.
    const Eigen::Vector3d middle = problem.body()->mesh.nodes.rowwise().mean();
    const auto rigid = [&](Eigen::Index f, int s, int axis) {
      const Observed& seen = part.observed[f];
      const bool along_normal = seen.normal.cols() > 0;
      const int point = along_normal ? s : s / 3;
      if (seen.count[point] == 0) return 0.0;
      Eigen::Vector3d motion = Eigen::Vector3d::Unit(axis % 3);
      if (axis >= 3) motion = motion.cross(Eigen::Vector3d(seen.measured.col(point) - middle));
      return along_normal ? motion.dot(seen.normal.col(point)) : motion[s % 3];
    };
    NuisanceCandidate bad{"bad_frame",
                          fmt::format("the frame at {:.3f} s of {}", times[worst], item.name),
                          "leave that frame out, or measure it again",
                          std::log(static_cast<double>(frames)),
                          {},
                          {}};
    NuisanceCandidate drift{"registration_drift",
                            "a slow drift of the measuring frame of " + item.name,
                            "register the recording to the fixture",
                            0,
                            {},
                            {}};
    bad.is_of_single_frames = true;
    bad.by.resize(misfit.residual.size(), 6);
    drift.by.resize(misfit.residual.size(), 6);
    for (int axis = 0; axis < 6; ++axis) {
      bad.by.col(axis) = FrameColumn(misfit, part, [&](Eigen::Index f, int s) {
        return f == worst ? rigid(f, s, axis) : 0.0;
      });
      const double duration = times.back() - times.front();
      drift.by.col(axis) = FrameColumn(misfit, part, [&](Eigen::Index f, int s) {
        return rigid(f, s, axis) * (times[f] - times.front()) / duration;
      });
      bad.priors.push_back({0, axis < 3 ? kMisplaced : kMisturned, false});
      drift.priors.push_back({0, axis < 3 ? kMisplaced : kMisturned, false});
    }
    candidates.push_back(std::move(bad));
    candidates.push_back(std::move(drift));
  }
  return candidates;
}

}  // namespace lacuna
