#include "prediction/predicted_motion.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/grip_tracks.h"
#include "experiment/known_loads.h"
#include "experiment/scan_grips.h"
#include "experiment/surface_observer.h"
#include "prediction/reading_times.h"

namespace lacuna {
namespace {

using Kind = MisfitDirection::Kind;

// The smallest share of the patches that a scan must show. Larger: small visible parts are refused;
// smaller: a scan in another unit of length, inside the object, is taken for one of it.
constexpr double kFewestSeen = 0.05;
// A scan whose points are on average farther from the undeformed surface than this share of the
// object's size shows something else: a straight rod that bends from one end into any other
// direction moves its points by half of its length on average.
constexpr double kElsewhere = 0.75;

double ShareUsed(const Observed& observed) {
  return observed.offered > 0 ? static_cast<double>(observed.used) / observed.offered : 0;
}

// For each frame, the positions (3 × nodes) of all nodes, with those of grips that follow the scan
// moved by their grip.
std::vector<Eigen::Matrix3Xd> FollowGrips(const PredictedRecording& item, double reach,
                                          bool tells_the_shape, const TetMesh& mesh,
                                          const BoundarySurface& boundary) {
  const bool rests_at_first =
      tells_the_shape && item.recording.reference.source == ReferenceSource::kFirstFrame;
  std::vector<Eigen::Matrix3Xd> moved(item.frames.size(), mesh.nodes);
  for (const RecordedGrip& grip : item.recording.object.grips) {
    if (grip.motion != GripMotion::kFollowsScan) continue;
    const std::vector<int> nodes =
        NamingWhere(item.recording.file.string(), [&] { return SelectNodes(grip.region, mesh); });
    const std::vector<Eigen::Isometry3d> motions = FollowGrip(
        *item.scans, item.frames, boundary, {grip.region.name, nodes, reach, rests_at_first});
    for (size_t k = 0; k < motions.size(); ++k)
      for (const int node : nodes) moved[k].col(node) = motions[k] * mesh.nodes.col(node);
  }
  return moved;
}

void MoveGrips(const PredictedRecording& item, double reach, bool tells_the_shape,
               const TetMesh& mesh, const BoundarySurface& boundary, GripTracks* grips) {
  const bool is_scan = item.scans != nullptr;
  std::vector<Eigen::Matrix3Xd> moved;
  if (is_scan) moved = FollowGrips(item, reach, tells_the_shape, mesh, boundary);
  for (size_t k = 0; k < item.frames.size(); ++k) {
    const int frame = item.frames[k];
    const RecordedGrip* lost =
        grips->Extend(item.recording.times[frame], mesh.nodes, is_scan ? moved[k] : mesh.nodes,
                      is_scan ? Eigen::Matrix3Xd(3, 0) : item.recording.markers.positions[frame]);
    // A grip's motion is interpolated across frames that do not show it, but cannot be extrapolated
    // before the first frame or after the last.
    if (lost != nullptr && (k == 0 || k + 1 == item.frames.size()))
      throw InputError(fmt::format(
          "{}: frame {}, the {} that is used, shows too few of the markers that \"{}\" follows: "
          "change `{}`",
          item.recording.file.string(), frame, k == 0 ? "first" : "last", lost->region.name,
          k == 0 ? "from" : "to"));
  }
}

// A scanned object that is not held must rest in its first frames.
void RequireStartAtRest(const PredictedRecording& item) {
  if (item.hold) return;
  const ScannedPoints& first = item.scans->At(item.frames.front());
  const double step = LargestMove(first, item.scans->At(item.frames[1]));
  const double whole = LargestMove(first, item.scans->At(item.frames.back()));
  constexpr double kNoise = 4;  // standard deviations of one point
  if (step > 0.25 * whole && step > kNoise * first.noise) {
    throw InputError(fmt::format(
        "{}: the object already moves between its first two frames, by {:.2f} mm; a prediction "
        "starts from rest: give `from:` or `hold:`",
        item.recording.file.string(), 1e3 * step));
  }
}

// Rotates the vectors that are stacked in the columns of `stacked`.
template <typename Stacked>
void Turn(const Eigen::Matrix3d& turn, Stacked* stacked) {
  if (stacked->size() == 0) return;
  const Eigen::Matrix3Xd turned = turn * stacked->reshaped(3, stacked->size() / 3);
  *stacked = turned.reshaped(stacked->rows(), stacked->cols());
}

// Gives the misfit of a reading the rows of exactly `frames` frames. Where a prediction stops
// early, a load cell with a delay may have reached more or fewer of them; the latter count as not
// read.
void Truncate(size_t frames, const MeasuredReaction& reading, ReactionMisfit* misfit) {
  misfit->components = reading.Components();
  const Eigen::Index before = misfit->residual.size();
  const Eigen::Index rows = misfit->components * static_cast<Eigen::Index>(frames);
  misfit->residual.conservativeResize(rows);
  misfit->jacobian.conservativeResize(rows, misfit->jacobian.cols());
  misfit->count.resize(static_cast<size_t>(rows), 0);
  if (rows <= before) return;
  misfit->residual.tail(rows - before).setZero();
  misfit->jacobian.bottomRows(rows - before).setZero();
}

// The motion of the nodes in one frame (3n, node-major).
struct NodalMotion {
  Eigen::VectorXd position, velocity;
  Eigen::MatrixXd jacobian;  // ∂position/∂(perturbation)

  void Register(const Eigen::Isometry3d& registration) {
    Turn(registration.linear(), &position);
    position += registration.translation().replicate(position.size() / 3, 1);
    Turn(registration.linear(), &velocity);
    Turn(registration.linear(), &jacobian);
  }
};

}  // namespace

Eigen::VectorXd Misfit::ResidualWithout(const Eigen::MatrixXd& place_offset) const {
  Eigen::VectorXd rest = residual;
  const Eigen::Index components = Components();
  for (size_t at = 0; at < count.size(); ++at) {
    const int point = static_cast<int>(at) % points;
    if (count[at] == 0) continue;
    auto row = rest.segment(components * static_cast<Eigen::Index>(at), components);
    if (deformation.empty())
      row -= place_offset.col(point);
    else
      row -= deformation[at] * place_offset.col(point);
  }
  return rest;
}

namespace {

// Throws InputError where a marker's place is farther from the object than half of the object's
// size.
void RequireMarkersNear(const Recording& recording, const TetMesh& mesh) {
  constexpr double kFar = 0.5;
  const Eigen::AlignedBox3d box(mesh.nodes.rowwise().minCoeff(), mesh.nodes.rowwise().maxCoeff());
  const double size = box.diagonal().norm();
  for (Eigen::Index m = 0; m < recording.markers.places.cols(); ++m) {
    const double away = box.exteriorDistance(Eigen::Vector3d(recording.markers.places.col(m)));
    if (away > kFar * size)
      throw InputError(fmt::format(
          "{}: marker_places: {} sits {:.3g} mm away from the object, which measures {:.3g} mm",
          recording.file.string(), recording.markers.names[static_cast<size_t>(m)], 1e3 * away,
          1e3 * size));
  }
}

}  // namespace

RecordingModel::RecordingModel(const PredictionStudy& study, const PredictedRecording& recording,
                               const TetMesh& mesh, std::shared_ptr<const Body> body,
                               const SurfacePatches& patches)
    : study_(study), item_(recording) {
  model_.body = std::move(body);
  model_.effects = study.effects;
  model_.effects.insert(model_.effects.end(), recording.effects.begin(), recording.effects.end());
  GripTracks grips(recording.recording, mesh, &model_);
  const bool tells_the_shape = &recording == &study.recordings.front();
  if (item_.scans != nullptr) {
    auto observer =
        std::make_unique<SurfaceObserver>(item_.scans, model_.body, patches, study.scan);
    if (study.scheme != TimeScheme::kQuasiStatic) RequireStartAtRest(item_);
    const double reach = observer->Reach();
    observer_ = std::move(observer);
    RequireThatScansShowTheObject();
    MoveGrips(item_, reach, tells_the_shape, mesh, model_.body->boundary, &grips);
  } else {
    // The elements of the body are in another order than those of `mesh`.
    RequireMarkersNear(item_.recording, mesh);
    observer_ = std::make_unique<MarkerObserver>(item_.recording, model_.body->mesh);
    MoveGrips(item_, 0, tells_the_shape, mesh, model_.body->boundary, &grips);
  }
  for (const auto& load : MakeKnownForces(recording.recording, model_))
    model_.effects.push_back(load);
  if (item_.hold) AddHold(mesh);
  if (item_.clock_deviation > 0) AddNuisance("clock", "s", item_.clock_deviation, {Kind::kClock});
  for (size_t k = 0; k < Reactions().size(); ++k) {
    const MeasuredReaction& reading = Reactions()[k];
    if (reading.delay_deviation > 0)
      AddNuisance(fmt::format("{}.{}_delay", reading.name, reading.Quantity()), "s",
                  reading.delay_deviation, {Kind::kCellDelay, static_cast<int>(k)});
  }
  for (const bool turns : {false, true}) {
    const double deviation = turns ? item_.turn_deviation : item_.shift_deviation;
    for (int axis = 0; deviation > 0 && axis < 3; ++axis)
      AddNuisance(fmt::format("{}_{}", turns ? "turn" : "shift", "xyz"[axis]), turns ? "rad" : "m",
                  deviation, {turns ? Kind::kTurn : Kind::kShift, axis});
  }
  AddPlacements();
}

void RecordingModel::RequireThatScansShowTheObject() {
  // Reads all frames, so that one that cannot be read is reported before the long computation.
  for (const int frame : item_.frames) item_.scans->At(frame);
  const Observed first =
      observer_->Observe(item_.frames.front(), model_.body->mesh.nodes.reshaped());
  shown_ = ShareUsed(first);
  const bool may_be_deformed = study_.scheme == TimeScheme::kQuasiStatic && shown_ < 0.5;
  if (!Shows(first) || may_be_deformed) shown_ = 1;
  const double size = BoundingBoxDiagonal(model_.body->mesh.nodes);
  if (Shows(first) || first.distance < kElsewhere * size) return;
  throw InputError(fmt::format(
      "{}: frame {} shows {} of {} patches of the undeformed surface: its points lie elsewhere, "
      "farther than any deformation could move the object, or their length unit or transform is "
      "wrong",
      item_.recording.file.string(), item_.frames.front(), (first.count.array() > 0).count(),
      PointCount()));
}

bool RecordingModel::Shows(const Observed& observed) const {
  return (observed.count.array() > 0).count() >= kFewestSeen * PointCount();
}

std::vector<int> RecordingModel::FittedFrames() const {
  std::vector<int> frames;
  if (!item_.fitted) return frames;
  for (const int frame : item_.frames)
    if (item_.recording.times[frame] <= item_.fit_until) frames.push_back(frame);
  return frames;
}

RecordingModel RecordingModel::With(const EffectList& effects) const {
  RecordingModel with = *this;
  CHECK_EQ(effects.size(), study_.effects.size());
  std::copy(effects.begin(), effects.end(), with.model_.effects.begin());
  return with;
}

Misfit RecordingModel::Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                               const std::vector<MisfitDirection>& directions,
                               const PredictionHints& hints) const {
  PredictionOptions options = Options(nuisance);
  const Model placed = PlacedModel(nuisance);
  options.reactions = MeasuredReactions(Reactions(), placed);
  if (hints.near_equilibrium != nullptr) options.held_guess = *hints.near_equilibrium;
  std::vector<double> of_frames;
  for (const int frame : frames) of_frames.push_back(item_.recording.times[frame]);
  const std::vector<double> of_model = Delayed(of_frames, Delay(nuisance));
  std::vector<std::vector<double>> of_cells(Reactions().size());
  for (size_t k = 0; k < of_cells.size(); ++k)
    if (Reactions()[k].delay_deviation > 0) of_cells[k] = Delayed(of_model, CellDelay(k, nuisance));
  const std::vector<ReadingTime> visits = ReadingTimesOf(of_model, of_cells);

  // The derivatives by clock and registration follow from velocity and position, without a tangent.
  std::vector<Perturbation> perturbations;
  std::vector<Eigen::Index> column;
  for (const MisfitDirection& direction : directions) {
    column.push_back(static_cast<Eigen::Index>(perturbations.size()));
    if (direction.IsSimulated()) perturbations.push_back(PerturbationBy(direction, nuisance));
  }
  const Eigen::Isometry3d registration = Registration(nuisance);
  const bool is_registered = item_.shift_deviation > 0 || item_.turn_deviation > 0;

  Misfit misfit;
  misfit.points = PointCount();
  misfit.reactions.resize(Reactions().size());
  const Eigen::Index components = observer_->Components();
  const Eigen::Index rows_of_frame = components * misfit.points;
  misfit.residual.resize(rows_of_frame * static_cast<Eigen::Index>(frames.size()));
  misfit.jacobian.setZero(misfit.residual.size(), static_cast<Eigen::Index>(directions.size()));
  misfit.summary = lacuna::Predict(
      placed, options, TimesOf(visits), perturbations,
      [&](int number, const PredictedState& state) {
        const ReadingTime& visit = visits[static_cast<size_t>(number)];
        const Eigen::Index index = static_cast<Eigen::Index>(visit.frame);
        for (const size_t k : visit.cells)
          AppendReaction(Reactions(), k, of_frames[visit.frame], state, options.start_time,
                         directions, &misfit.reactions[k]);
        if (!visit.shows_frame) return;
        NodalMotion nodal{state.position, state.velocity, {}};
        if (!perturbations.empty()) nodal.jacobian = state.position_jacobian;
        if (is_registered) nodal.Register(registration);
        Observed seen =
            hints.observed != nullptr
                ? (*hints.observed)[visit.frame]
                : observer_->ObserveWithin(hints.reach_factor, frames[visit.frame], nodal.position);
        const bool moves = state.time > options.start_time;
        const auto derivative = [&](size_t k) -> Eigen::VectorXd {
          switch (directions[k].kind) {
            case Kind::kModel:
            case Kind::kGripShift:
            case Kind::kGripTurn:
              return nodal.jacobian.col(column[k]);
            case Kind::kClock:
              return (moves ? -1.0 : 0.0) * nodal.velocity;
            case Kind::kCellDelay:
              return Eigen::VectorXd::Zero(nodal.position.size());
            case Kind::kShift:
            case Kind::kTurn:
              break;
          }
          Eigen::Matrix3Xd rigid(3, nodal.position.size() / 3);
          for (Eigen::Index a = 0; a < rigid.cols(); ++a)
            rigid.col(a) =
                ByRegistration(directions[k], registration, nodal.position.segment<3>(3 * a));
          return rigid.reshaped();
        };
        const Eigen::Index begin = rows_of_frame * index;
        misfit.residual.segment(begin, rows_of_frame) = *seen.rows * nodal.position - seen.target;
        for (size_t k = 0; k < directions.size(); ++k)
          misfit.jacobian.col(static_cast<Eigen::Index>(k)).segment(begin, rows_of_frame) =
              *seen.rows * derivative(k);
        for (int point = 0; point < misfit.points; ++point) {
          misfit.count.push_back(seen.count[point]);
          if (seen.count[point] > 0) continue;
          misfit.residual.segment(begin + components * point, components).setZero();
          misfit.jacobian.middleRows(begin + components * point, components).setZero();
        }
        for (const Eigen::Matrix3d& F : seen.deformation)
          misfit.deformation.emplace_back(registration.linear() * F);
        misfit.frames.push_back(frames[visit.frame]);
        misfit.observed.push_back(std::move(seen));
      });
  const Eigen::Index reached = rows_of_frame * static_cast<Eigen::Index>(misfit.frames.size());
  misfit.residual.conservativeResize(reached);
  misfit.jacobian.conservativeResize(reached, Eigen::NoChange);
  of_frames.resize(misfit.frames.size());
  for (size_t k = 0; k < misfit.reactions.size(); ++k) {
    Truncate(misfit.frames.size(), Reactions()[k], &misfit.reactions[k]);
    ChooseSign(Reactions()[k], of_frames, &misfit.reactions[k]);
  }
  return misfit;
}

std::vector<int> RecordingModel::LostFrames(const Misfit& misfit, double least) const {
  std::vector<int> lost;
  if (item_.scans == nullptr) return lost;
  double best = shown_;
  for (const Observed& observed : misfit.observed) best = std::max(best, ShareUsed(observed));
  for (size_t f = 0; f < misfit.observed.size(); ++f)
    if (ShareUsed(misfit.observed[f]) < least * best) lost.push_back(misfit.frames[f]);
  return lost;
}

}  // namespace lacuna
