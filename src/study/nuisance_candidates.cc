#include "study/nuisance_candidates.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/error.h"
#include "geometry/rigid_fit.h"
#include "study/reference.h"

namespace lacuna {
namespace {

constexpr double kShift = 1e-3;  // m, by how much a grip, a frame, a registration may be off
constexpr double kTurn = 0.02;   // rad
// How well the object's dimensions are known, in parts of them: 0.05 mm of 17 mm.
constexpr double kShape = 0.003;
// By how much frames may be mistimed, in parts of their distance.
constexpr double kJitter = 0.1;
// How much smaller elements are looked at; and what refining them without end would change, in
// parts of the change that this makes. The error of quadratic ones goes with their volume to the
// power of about 0.7 beside a clamped edge: 1/(1 − ratio^−0.7), known to what it exceeds 1 by, and
// no better than 0.4.
constexpr double kVolumePower = 0.7;
constexpr double kFineElements = 2000, kLeastVolumeRatio = 4, kMostVolumeRatio = 12;
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
// More frames than this, and single frames are too small a part to be looked at one by one.
constexpr size_t kMostFrames = 400;

struct GripShape {
  Eigen::VectorXi nodes;
  Eigen::Vector3d centre;
};

// A rigid motion of one grip's nodes.
Eigen::VectorXd RigidMotion(const GripShape& grip, const Eigen::Matrix3Xd& rest,
                            const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * rest.cols());
  for (const int node : grip.nodes)
    motion.segment<3>(3 * node) = shift + turn.cross(rest.col(node) - grip.centre);
  return motion;
}

MisfitDirection Placed(Eigen::VectorXd motion) {
  MisfitDirection direction;
  direction.perturbation.grip = [motion = std::move(motion)](double, const Eigen::VectorXd&) {
    return motion;
  };
  return direction;
}

// Yields to the resultant of the grip's reaction (or turns with its moment); `largest` follows the
// motion per unit of compliance.
MisfitDirection Yielding(const GripShape& grip, const Eigen::Matrix3Xd& rest, bool turns,
                         std::shared_ptr<double> largest) {
  MisfitDirection direction;
  direction.perturbation.grip = [grip, rest, turns, largest = std::move(largest)](
                                    double, const Eigen::VectorXd& reaction) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (const int node : grip.nodes) {
      const Eigen::Vector3d here = reaction.segment<3>(3 * node);
      force += here;
      moment += (rest.col(node) - grip.centre).cross(here);
    }
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Eigen::VectorXd motion =
        turns ? RigidMotion(grip, rest, zero, -moment) : RigidMotion(grip, rest, -force, zero);
    *largest = std::max(*largest, turns ? moment.norm() : force.norm());
    return motion;
  };
  return direction;
}

// One column of rows that are marker coordinates.
Eigen::VectorXd FrameColumn(const LinearisedMisfit& misfit, const LinearisedMisfit::Part& part,
                            const std::function<double(Eigen::Index frame, int series)>& value) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(misfit.residual.size());
  for (Eigen::Index f = 0; f < static_cast<Eigen::Index>(part.layout.times.size()); ++f)
    for (int s = 0; s < part.layout.series; ++s)
      column[part.first_row + f * part.layout.series + s] = value(f, s);
  return column;
}

// How many times smaller elements are looked at: as few as a study of the mesh needs.
double MeshRatio(const CalibrationProblem& problem) {
  const double elements = static_cast<double>(problem.body()->ElementCount());
  return std::clamp(kFineElements / elements, kLeastVolumeRatio, kMostVolumeRatio);
}
double MeshLimit(double ratio) { return 1 / (1 - std::pow(ratio, -kVolumePower)); }

}  // namespace

namespace {

constexpr char kCompliance[] = "grip_compliance";
constexpr char kStrain[] = "strain";  // of what is gripped; for the jitter alone
// Along which markers tell a strain, in parts of their largest extent (geometry/rigid_fit.cc).
constexpr double kSpanned = 0.05;

// The recorded grip that is this one of the model; null: it is fixed.
const RecordedGrip* RecordedAs(const Recording& recording, size_t grip) {
  const size_t fixed = recording.fixed.size();  // what is fixed comes first
  return grip < fixed || grip - fixed >= recording.grips.size() ? nullptr
                                                                : &recording.grips[grip - fixed];
}

bool Deforms(const CalibrationProblem& problem, size_t grip) {
  return std::any_of(problem.models().begin(), problem.models().end(), [&](const auto& model) {
    const RecordedGrip* recorded = RecordedAs(model.item().recording, grip);
    return recorded != nullptr && recorded->deforms;
  });
}

}  // namespace

GripNuisances::GripNuisances(const CalibrationProblem& problem) {
  const Model& model = problem.models().front().model();
  const Eigen::Matrix3Xd& rest = model.body->mesh.nodes;
  for (size_t g = 0; g < model.grips.size(); ++g) {
    GripShape grip{model.grips[g].nodes, Eigen::Vector3d::Zero()};
    if (grip.nodes.size() == 0) continue;
    grip.centre = rest(Eigen::all, grip.nodes).rowwise().mean();
    const std::string of =
        model.grips.size() > 1 ? fmt::format(" of grip {}", g + 1) : " of the grip";

    Kind placement{"grip_placement",
                   "the placement" + of,
                   "measure where the grip holds the object, or fit it",
                   g,
                   static_cast<int>(directions_.size()),
                   6,
                   {},
                   {}};
    for (int axis = 0; axis < 6; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis % 3);
      const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
      directions_.push_back(Placed(axis < 3 ? RigidMotion(grip, rest, unit, zero)
                                            : RigidMotion(grip, rest, zero, unit)));
      placement.largest.push_back(nullptr);
      placement.deviation.push_back(axis < 3 ? kShift : kTurn);
    }
    kinds_.push_back(std::move(placement));

    Kind compliance{kCompliance,
                    "the compliance or the extent" + of,
                    "check how far the clamp reaches and whether it yields or slips",
                    g,
                    static_cast<int>(directions_.size()),
                    2,
                    {},
                    {}};
    for (const bool turns : {false, true}) {
      auto largest = std::make_shared<double>(0);
      directions_.push_back(Yielding(grip, rest, turns, largest));
      compliance.largest.push_back(largest);
      compliance.deviation.push_back(turns ? kTurn : kShift);
    }
    kinds_.push_back(std::move(compliance));
    if (!Deforms(problem, g)) continue;
    // What is gripped is stretched and sheared: node − centre times each unit matrix.
    kinds_.push_back({kStrain, {}, {}, g, static_cast<int>(directions_.size()), 9, {}, {}});
    for (int entry = 0; entry < 9; ++entry) {
      Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * rest.cols());
      for (const int node : grip.nodes)
        motion[3 * node + entry % 3] = rest(entry / 3, node) - grip.centre[entry / 3];
      directions_.push_back(Placed(std::move(motion)));
    }
  }
}

std::vector<NuisanceCandidate> GripNuisances::Candidates(const Eigen::MatrixXd& by) const {
  std::vector<NuisanceCandidate> candidates;
  for (const Kind& kind : kinds_) {
    if (kind.name == kStrain) continue;
    NuisanceCandidate candidate{kind.name, kind.what, kind.advice, 0, {}, {}};
    candidate.by = by.middleCols(kind.first, kind.count);
    for (int k = 0; k < kind.count; ++k) {
      double deviation = kind.deviation[k];
      if (kind.largest[k] != nullptr && *kind.largest[k] > 0) deviation /= *kind.largest[k];
      candidate.priors.push_back({0, deviation, false});
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

namespace {

// Of the markers that it follows, by their order in the recording.
std::vector<int> MarkersOf(const RecordedGrip& grip, const Recording& recording) {
  const auto& names = recording.markers.names;
  std::vector<int> markers;
  for (const std::string& name : grip.markers)
    markers.push_back(
        static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin()));
  return markers;
}

}  // namespace

// In a frame, as combinations of the columns of a kind's directions, each of unit deviation.
Eigen::MatrixXd GripNuisances::JitterOf(const Kind& kind, const RecordedGrip& grip,
                                        const Eigen::Matrix3Xd& places, double noise) const {
  const Eigen::Matrix3Xd about = places.colwise() - Eigen::Vector3d(places.rowwise().mean());
  const double shift = noise / std::sqrt(static_cast<double>(places.cols()));
  if (kind.name == kStrain) {
    // Along what the markers span (FitAffineMotion): errors e of the images of its axes u, e uᵀ.
    const Eigen::JacobiSVD<Eigen::Matrix3Xd> shape(about, Eigen::ComputeThinU);
    Eigen::MatrixXd combined(9, 0);
    for (Eigen::Index k = 0; k < shape.singularValues().size(); ++k) {
      const double extent = shape.singularValues()[k];
      if (extent <= kSpanned * shape.singularValues()[0]) break;
      for (int axis = 0; axis < 3; ++axis) {
        combined.conservativeResize(Eigen::NoChange, combined.cols() + 1);
        combined.rightCols(1) =
            (noise / extent * Eigen::Vector3d::Unit(axis) * shape.matrixU().col(k).transpose())
                .reshaped();
      }
    }
    return combined;
  }
  Eigen::MatrixXd combined = Eigen::MatrixXd::Zero(6, grip.deforms ? 3 : 6);
  combined.topLeftCorner<3, 3>().diagonal().setConstant(shift);
  for (int axis = 0; axis < 3 && !grip.deforms; ++axis) {
    const double lever = std::sqrt(about.squaredNorm() - about.row(axis).squaredNorm());
    if (FitRigidMotion(places, places).span == 2) combined(3 + axis, 3 + axis) = noise / lever;
  }
  return combined;
}

std::optional<NuisanceCandidate> GripNuisances::Jitter(const CalibrationProblem& problem,
                                                       const LinearisedMisfit& misfit,
                                                       const Eigen::MatrixXd& by) const {
  if (problem.study().scheme != TimeScheme::kQuasiStatic) return std::nullopt;
  NuisanceCandidate jitter{"grip_jitter", "the noise of the markers that grips follow",
                           "measure the grips' motion more exactly, or with more markers"};
  jitter.is_always_taken = true;
  std::vector<Eigen::VectorXd> columns;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const Recording& recording = problem.models()[part.recording].item().recording;
    const Eigen::Index series = part.layout.series;
    if (part.layout.times.size() > kMostFrames) continue;
    for (const Kind& kind : kinds_) {
      const RecordedGrip* grip = RecordedAs(recording, kind.grip);
      if (kind.name == kCompliance || grip == nullptr ||
          grip->motion != GripMotion::kFollowsMarkers || (kind.name == kStrain && !grip->deforms))
        continue;
      const std::vector<int> markers = MarkersOf(*grip, recording);
      Eigen::MatrixXd of_frame =
          by.middleCols(kind.first, kind.count) *
          JitterOf(kind, *grip, recording.marker_places(Eigen::all, markers), problem.noise());
      // The grip goes with the markers' errors: by what it is shaken with, these are not off.
      for (size_t f = 0; f < part.layout.times.size(); ++f)
        for (const int marker : markers)
          of_frame
              .middleRows<3>(part.first_row + static_cast<Eigen::Index>(f) * series + 3 * marker)
              .setZero();
      for (size_t f = 0; f < part.layout.times.size(); ++f)
        for (const auto& column : of_frame.colwise()) {
          const Eigen::Index row = part.first_row + static_cast<Eigen::Index>(f) * series;
          columns.emplace_back(Eigen::VectorXd::Zero(by.rows()));
          columns.back().segment(row, series) = column.segment(row, series);
        }
    }
  }
  if (columns.empty()) return std::nullopt;
  jitter.by.resize(by.rows(), static_cast<Eigen::Index>(columns.size()));
  for (size_t k = 0; k < columns.size(); ++k)
    jitter.by.col(static_cast<Eigen::Index>(k)) = columns[k];
  jitter.priors.assign(columns.size(), {0, 1, false});
  return jitter;
}

namespace {

// The residual with elements that have a part of the volume; empty where it cannot be had.
Eigen::VectorXd WithFinerMesh(const PredictionStudy& study, double ratio,
                              const Eigen::VectorXd& values) {
  PredictionStudy fine = study;
  fine.mesh.tets.max_volume /= ratio;
  try {
    const ReferenceBody reference = MakeReferenceBody(fine);
    return CalibrationProblem(fine, reference.mesh).Linearise(values, false).residual;
  } catch (const InputError&) {
    return {};  // a shape that cannot be meshed more finely says nothing about its mesh
  }
}

}  // namespace

Eigen::VectorXd ChangeByMesh(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                             double steps) {
  PredictionStudy study = problem.AsChosen();
  study.time_step *= steps;
  const double ratio = MeshRatio(problem);
  const Eigen::VectorXd coarse =
      CalibrationProblem(study, problem.body()->mesh).Linearise(values, false).residual;
  const Eigen::VectorXd fine = WithFinerMesh(study, ratio, values);
  problem.SetModel(values);  // the refined model shares its effects
  if (fine.size() != coarse.size() || fine == coarse) return {};
  return MeshLimit(ratio) * (fine - coarse);
}

namespace {

std::optional<NuisanceCandidate> MeshNuisance(const CalibrationProblem& problem,
                                              const Eigen::VectorXd& values,
                                              const LinearisedMisfit& misfit) {
  const PredictionStudy study = problem.AsChosen();
  const double ratio = MeshRatio(problem);
  const Eigen::VectorXd fine = WithFinerMesh(study, ratio, values);
  const Eigen::VectorXd between = WithFinerMesh(study, ratio / 2, values);
  if (fine.size() != misfit.residual.size() || between.size() != fine.size()) return std::nullopt;
  NuisanceCandidate candidate{"mesh", "the size of the elements",
                              "choose a smaller mesh.max_volume"};
  candidate.by.resize(fine.size(), 2);
  candidate.by << fine - misfit.residual, fine - between;
  const double limit = MeshLimit(ratio);
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
    PredictionStudy slow = problem.AsChosen();
    slow.time_step /= ratio;
    return CalibrationProblem(slow, problem.body()->mesh).Linearise(values, false).residual;
  };
  const Eigen::VectorXd half = with_steps(2), quarter = with_steps(4);
  if (half.size() != misfit.residual.size() || quarter.size() != half.size()) return std::nullopt;
  NuisanceCandidate candidate{"time_step", "the length of the step",
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
  const PredictionStudy study = problem.AsChosen();
  NuisanceCandidate candidate{"shape", "the object's dimensions", "measure the object again"};
  candidate.by = Eigen::MatrixXd::Zero(misfit.residual.size(), 3);
  candidate.is_always_taken = true;
  for (int axis = 0; axis < 3; ++axis) {
    TetMesh larger = mesh;
    larger.nodes.row(axis).array() += kShape * (mesh.nodes.row(axis).array() - centre[axis]);
    const LinearisedMisfit changed = CalibrationProblem(study, larger).Linearise(values, false);
    if (!changed.usable || changed.residual.size() != misfit.residual.size()) return std::nullopt;
    candidate.by.col(axis) = changed.residual - misfit.residual;
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
  problem.SetModel(values);  // the changed models share its effects
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
    if (times.size() <= kMostFrames) {
      NuisanceCandidate jitter{"time_jitter",
                               "the times of single frames of " + item.name,
                               "check the camera's clock and its exposure",
                               0,
                               {},
                               {}};
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
      bad.priors.push_back({0, axis < 3 ? kShift : kTurn, false});
      drift.priors.push_back({0, axis < 3 ? kShift : kTurn, false});
    }
    candidates.push_back(std::move(bad));
    candidates.push_back(std::move(drift));
  }
  return candidates;
}

}  // namespace lacuna
