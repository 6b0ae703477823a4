// The noise of the markers that the grips follow, in quasi-static motions.
//
// In each frame a grip is fitted to markers with independent errors of standard deviation σ. A
// rigid grip is then shifted by σ/√n per axis and rotated by σ/√Σd² about each axis, with d the
// distances of its n markers from that axis, to where the grip has turned them by then; a deforming
// grip has errors in its linear map instead of rotations. Each column is one such error, of unit
// variance, in one frame.
#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/single_frame_columns.h"
#include "diagnosis/thresholds.h"
#include "experiment/grip_tracks.h"
#include "geometry/rigid_fit.h"
#include "prediction/reading_times.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_jitter";
  card.title = "the noise of the markers that grips follow";
  card.directions =
      "in quasi-static motions, each grip that follows markers displaced in each frame by itself";
  card.prior = "what the noise of the markers does to the fitted grip";
  card.residual_when_present =
      "Single frames are displaced as a whole, in another direction each time.";
  card.advice = "measure the grips' motion more exactly, or with more markers";
  card.source = NuisanceSource::kGrip;
  card.is_always_in_model = true;
  card.needs_few_frames = true;
  return card;
}

// The errors of a grip's three shifts and three rotations (6 rows), one per column.
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

// The errors of a deforming grip's linear map (9 rows, column-major): e uᵀ, with the errors e of
// the images of the axes u that the markers span (FitAffineMotion).
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

// One kind of error of one grip in the frames of a recording: a combination, of its own in each
// frame, of some motions of the grip.
struct FrameErrors {
  const LinearisedMisfit::Part* points;  // of the recording
  std::vector<int> markers;              // that the grip follows
  Eigen::Index first_motion = 0;         // in GripMotions
  // motions × errors, for each frame
  std::vector<Eigen::MatrixXd> jitter;

  Eigen::Index PerFrame() const { return jitter.front().cols(); }
  Eigen::Index Columns() const { return static_cast<Eigen::Index>(jitter.size()) * PerFrame(); }
};

// The places of the markers that a grip follows, 3 × markers, rotated like the grip in each frame.
// Where their middle is does not matter.
std::vector<Eigen::Matrix3Xd> TurnedPlaces(const RecordingModel& model,
                                           const Eigen::VectorXd& nuisance, size_t grip,
                                           const Eigen::Matrix3Xd& places,
                                           const std::vector<double>& times) {
  const Grip held = model.PlacedModel(nuisance).grips[grip];
  const Eigen::Matrix3Xd at_rest = model.model().body->mesh.nodes(Eigen::all, held.nodes);
  std::vector<Eigen::Matrix3Xd> turned;
  for (const double time : Delayed(times, model.Delay(nuisance)))
    turned.push_back(FitRigidMotion(at_rest, held.motion(time)).motion.linear() * places);
  return turned;
}

// The grips that follow markers in the recording of `points`.
std::vector<const GripMotions::Grip*> Followers(const LinearisedMisfit::Part& points,
                                                const NuisanceContext& at) {
  const Recording& recording = at.problem.models()[points.recording].measured();
  std::vector<const GripMotions::Grip*> followers;
  for (const GripMotions::Grip& grip : at.grips.grips) {
    const std::optional<size_t> index = grip.In(points.recording);
    const RecordedGrip* recorded = index ? RecordedAs(recording, *index) : nullptr;
    if (recorded != nullptr && recorded->motion == GripMotion::kFollowsMarkers)
      followers.push_back(&grip);
  }
  return followers;
}

// Appends the errors of one of these grips.
void AppendErrors(const GripMotions::Grip& own, const LinearisedMisfit::Part& points,
                  const NuisanceContext& at, std::vector<FrameErrors>* errors) {
  const RecordingModel& model = at.problem.models()[points.recording];
  const size_t index = *own.In(points.recording);
  const RecordedGrip& grip = *RecordedAs(model.measured(), index);
  const double noise = at.problem.noise();
  const std::vector<double>& times = points.layout.times;
  const Eigen::VectorXd nuisance = at.problem.NuisanceOf(points.recording, at.values);
  const std::vector<int> markers = MarkersOf(grip, model.measured());
  const Eigen::Matrix3Xd places = model.measured().markers.places(Eigen::all, markers);
  FrameErrors rigid{&points, markers, own.rigid, {}};
  for (const Eigen::Matrix3Xd& turned : TurnedPlaces(model, nuisance, index, places, times))
    rigid.jitter.push_back(RigidJitter(turned, grip.deforms, noise));
  errors->push_back(std::move(rigid));
  if (!grip.deforms) return;
  errors->push_back({&points, markers, own.strain,
                     std::vector<Eigen::MatrixXd>(times.size(), StrainJitter(places, noise))});
}

// Fills in the columns from `first` on, one frame after another, with the changes by the errors of
// that frame, in its rows only.
void FillFrameByFrame(const FrameErrors& errors, const NuisanceContext& at, Eigen::Index first,
                      Eigen::MatrixXd* columns) {
  const LinearisedMisfit::Part& points = *errors.points;
  const Eigen::Index width = errors.PerFrame();
  for (Eigen::Index f = 0; f < static_cast<Eigen::Index>(errors.jitter.size()); ++f) {
    const Eigen::MatrixXd& jitter = errors.jitter[static_cast<size_t>(f)];
    for (const LinearisedMisfit::Part& part : at.misfit.parts) {
      if (part.recording != points.recording) continue;
      const Eigen::Index series = part.layout.series, row = part.first_row + f * series;
      columns->block(row, first + f * width, series, width) =
          at.grip_columns.block(row, errors.first_motion, series, jitter.rows()) * jitter;
    }
    // The grip follows the errors of its own markers, so it does not miss these.
    for (const int marker : errors.markers)
      columns
          ->block(points.first_row + f * points.layout.series + 3 * marker, first + f * width, 3,
                  width)
          .setZero();
  }
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  if (at.problem.study().scheme != TimeScheme::kQuasiStatic) return std::nullopt;
  NuisanceCandidate candidate;
  std::vector<FrameErrors> errors;
  for (const LinearisedMisfit::Part& part : at.misfit.parts) {
    if (!part.IsOfPoints()) continue;
    const std::vector<const GripMotions::Grip*> followers = Followers(part, at);
    if (followers.empty()) continue;
    if (part.layout.times.size() > kThresholds.nuisances.most_single_frames) {
      candidate.left_out.push_back(at.problem.models()[part.recording].recording().name);
      continue;
    }
    for (const GripMotions::Grip* grip : followers) AppendErrors(*grip, part, at, &errors);
  }
  if (errors.empty() && candidate.left_out.empty()) return std::nullopt;
  const Eigen::Index rows = at.misfit.residual.size();
  Eigen::Index count = 0;
  for (const FrameErrors& own : errors) count += own.Columns();
  candidate.untried = WhyTooLarge(rows, count);
  if (!candidate.untried.empty()) count = 0;
  candidate.columns.setZero(rows, count);
  if (count == 0) return candidate;
  candidate.priors.assign(static_cast<size_t>(count), {0, 1, false});
  Eigen::Index first = 0;
  for (const FrameErrors& own : errors) {
    FillFrameByFrame(own, at, first, &candidate.columns);
    first += own.Columns();
  }
  return candidate;
}

}  // namespace

NuisanceEntry GripJitterNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
