// The noise of the markers that the grips follow, in quasi-static motions.
//
// In each frame a grip is fitted to markers with independent errors of standard deviation σ. A
// rigid grip is then shifted by σ/√n per axis and rotated by σ/√Σd² about each axis, with d the
// distances of its n markers from that axis; a deforming grip has errors in its linear map instead
// of rotations. Each column is one such error, of unit variance, in one frame.
#include <Eigen/Geometry>
#include <cmath>

#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"
#include "experiment/grip_tracks.h"
#include "geometry/rigid_fit.h"

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

// Appends `shaken`, the change of all rows by an error that lasts, once for each frame of the
// recording of `points` and in its rows only.
void AppendFrameByFrame(const LinearisedMisfit& misfit, const LinearisedMisfit::Part& points,
                        const std::vector<int>& markers, Eigen::MatrixXd shaken,
                        Eigen::MatrixXd* columns) {
  const Eigen::Index frames = static_cast<Eigen::Index>(points.layout.times.size());
  const Eigen::Index first = columns->cols(), width = shaken.cols();
  columns->conservativeResize(Eigen::NoChange, first + frames * width);
  columns->rightCols(frames * width).setZero();
  for (Eigen::Index f = 0; f < frames; ++f) {
    // The grip follows the errors of its own markers, so it does not miss these.
    for (const int marker : markers)
      shaken.middleRows<3>(points.first_row + f * points.layout.series + 3 * marker).setZero();
    for (const LinearisedMisfit::Part& part : misfit.parts) {
      if (part.recording != points.recording) continue;
      const Eigen::Index series = part.layout.series, row = part.first_row + f * series;
      columns->block(row, first + f * width, series, width) = shaken.middleRows(row, series);
    }
  }
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  if (at.problem.study().scheme != TimeScheme::kQuasiStatic) return std::nullopt;
  const double noise = at.problem.noise();
  NuisanceCandidate candidate;
  candidate.columns.resize(at.misfit.residual.size(), 0);
  for (const LinearisedMisfit::Part& part : at.misfit.parts) {
    const Recording& recording = at.problem.models()[part.recording].measured();
    if (!part.IsOfPoints()) continue;
    for (const GripMotions::Grip& own : at.grips.grips) {
      const RecordedGrip* grip = RecordedAs(recording, own.grip);
      if (grip == nullptr || grip->motion != GripMotion::kFollowsMarkers) continue;
      if (part.layout.times.size() > kThresholds.nuisances.most_single_frames) {
        candidate.left_out.push_back(at.problem.models()[part.recording].recording().name);
        break;
      }
      const std::vector<int> markers = MarkersOf(*grip, recording);
      const Eigen::Matrix3Xd places = recording.markers.places(Eigen::all, markers);
      AppendFrameByFrame(
          at.misfit, part, markers,
          at.grip_columns.middleCols(own.rigid, 6) * RigidJitter(places, grip->deforms, noise),
          &candidate.columns);
      if (own.strain < 0 || !grip->deforms) continue;
      AppendFrameByFrame(at.misfit, part, markers,
                         at.grip_columns.middleCols(own.strain, 9) * StrainJitter(places, noise),
                         &candidate.columns);
    }
  }
  const Eigen::Index count = candidate.columns.cols();
  if (count == 0 && candidate.left_out.empty()) return std::nullopt;
  candidate.priors.assign(static_cast<size_t>(count), {0, 1, false});
  return candidate;
}

}  // namespace

NuisanceEntry GripJitterNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
