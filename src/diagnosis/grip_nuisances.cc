#include "diagnosis/grip_nuisances.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "experiment/grip_tracks.h"
#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

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

// The recorded grip that is this one of the model; null: it is fixed.
const RecordedGrip* RecordedAs(const Recording& recording, size_t grip) {
  const size_t fixed = recording.object.fixed.size();  // what is fixed comes first
  return grip < fixed || grip - fixed >= recording.object.grips.size()
             ? nullptr
             : &recording.object.grips[grip - fixed];
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

    Kind placement{Of::kPlacement,
                   "grip_placement",
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
      placement.deviation.push_back(axis < 3 ? kMisplaced : kMisturned);
    }
    kinds_.push_back(std::move(placement));

    Kind compliance{Of::kCompliance,
                    "grip_compliance",
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
      compliance.deviation.push_back(turns ? kMisturned : kMisplaced);
    }
    kinds_.push_back(std::move(compliance));
    if (!Deforms(problem, g)) continue;
    // Each unit matrix times node − centre.
    kinds_.push_back({Of::kStrain, {}, {}, {}, g, static_cast<int>(directions_.size()), 9, {}, {}});
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
    if (kind.of == Of::kStrain) continue;
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

// What the noise of markers at these places makes of a grip in one frame, each column of unit
// deviation: of its shifts and, in a rigid one, turns (6 rows) …
Eigen::MatrixXd RigidJitter(const Eigen::Matrix3Xd& places, bool deforms, double noise) {
  Eigen::MatrixXd jitter = Eigen::MatrixXd::Zero(6, deforms ? 3 : 6);
  jitter.diagonal().head<3>().setConstant(noise / std::sqrt(static_cast<double>(places.cols())));
  if (deforms || FitRigidMotion(places, places).span < 2) return jitter;
  const Eigen::Matrix3Xd about = places.colwise() - Eigen::Vector3d(places.rowwise().mean());
  for (int axis = 0; axis < 3; ++axis)
    jitter(3 + axis, 3 + axis) =
        noise / std::sqrt(about.squaredNorm() - about.row(axis).squaredNorm());
  return jitter;
}

// … and of its linear map (9 rows, column-major): errors e of the images of what the markers span,
// e uᵀ (FitAffineMotion).
Eigen::MatrixXd StrainJitter(const Eigen::Matrix3Xd& places, double noise) {
  const SpannedAxes spanned = AxesOf(places);
  Eigen::MatrixXd jitter(9, 3 * spanned.extent.size());
  for (Eigen::Index k = 0; k < spanned.extent.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      jitter.col(3 * k + axis) = (noise / spanned.extent[k] * Eigen::Vector3d::Unit(axis) *
                                  spanned.axis.col(k).transpose())
                                     .reshaped();
  return jitter;
}

}  // namespace

std::optional<NuisanceCandidate> GripNuisances::Jitter(const CalibrationProblem& problem,
                                                       const LinearisedMisfit& misfit,
                                                       const Eigen::MatrixXd& by) const {
  if (problem.study().scheme != TimeScheme::kQuasiStatic) return std::nullopt;
  NuisanceCandidate jitter{"grip_jitter", "the noise of the markers that grips follow",
                           "measure the grips' motion more exactly, or with more markers"};
  jitter.is_always_taken = true;
  jitter.by.resize(by.rows(), 0);
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const Recording& recording = problem.models()[part.recording].item().recording;
    const Eigen::Index series = part.layout.series;
    const Eigen::Index frames = static_cast<Eigen::Index>(part.layout.times.size());
    if (part.layout.times.size() > kMostFramesEach) continue;
    for (const Kind& kind : kinds_) {
      const RecordedGrip* grip = RecordedAs(recording, kind.grip);
      if (kind.of == Of::kCompliance || grip == nullptr ||
          grip->motion != GripMotion::kFollowsMarkers || (kind.of == Of::kStrain && !grip->deforms))
        continue;
      const std::vector<int> markers = MarkersOf(*grip, recording);
      const Eigen::Matrix3Xd places = recording.markers.places(Eigen::all, markers);
      Eigen::MatrixXd shaken =
          by.middleCols(kind.first, kind.count) *
          (kind.of == Of::kStrain ? StrainJitter(places, problem.noise())
                                  : RigidJitter(places, grip->deforms, problem.noise()));
      const Eigen::Index first = jitter.by.cols(), width = shaken.cols();
      jitter.by.conservativeResize(Eigen::NoChange, first + frames * width);
      jitter.by.rightCols(frames * width).setZero();
      for (Eigen::Index f = 0; f < frames; ++f) {
        const Eigen::Index row = part.first_row + f * series;
        // The grip goes with the markers' errors: by what it is shaken with, these are not off.
        for (const int marker : markers) shaken.middleRows<3>(row + 3 * marker).setZero();
        jitter.by.block(row, first + f * width, series, width) = shaken.middleRows(row, series);
      }
    }
  }
  if (jitter.by.cols() == 0) return std::nullopt;
  jitter.priors.assign(static_cast<size_t>(jitter.by.cols()), {0, 1, false});
  return jitter;
}

}  // namespace lacuna
