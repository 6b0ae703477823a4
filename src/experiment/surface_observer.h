// Compares scans with a model by the distance of scanned points from its surface, patch by patch.
#ifndef LACUNA_EXPERIMENT_SURFACE_OBSERVER_H_
#define LACUNA_EXPERIMENT_SURFACE_OBSERVER_H_

#include <Eigen/Core>
#include <memory>

#include "experiment/observer.h"
#include "experiment/scan_frames.h"
#include "fem/body.h"
#include "geometry/surface_patches.h"

namespace lacuna {

// Each scanned point p_j corresponds to the nearest place x_j = Σ_a N_a(ξ_j) x_a of the model's
// surface, which is curved where the mesh is quadratic, and to the patch of that place. The row of
// a patch is the mean over its points of
//   n_j · (x_j − p_j),  n_j the surface's outward normal at x_j,
// which is linear in the nodes' positions for fixed ξ_j and n_j (point-to-plane: Chen & Medioni,
// Image and Vision Computing 10, 1992). Motion of the surface within itself leaves the row
// unchanged, as scans contain no information about it.
//
// Points beside a face, beyond its edge, are compared with the edge (scan_matches.h). Points are
// left out if they are farther away than the reach, if their normal deviates by more than 60° from
// that of the surface, or if they differ from the median of their patch by more than four times its
// spread (or the noise, if that is larger). A patch with fewer than three remaining points is not
// seen.
class SurfaceObserver : public Observer {
 public:
  SurfaceObserver(std::shared_ptr<const ScanFrames> scans, std::shared_ptr<const Body> body,
                  const SurfacePatches& patches, const ScanSettings& settings);
  int PointCount() const override { return patches_.Count(); }
  int Components() const override { return 1; }
  const Eigen::Matrix3Xd& Places() const override { return patches_.place; }
  Observed ObserveWithin(double reach_factor, int frame,
                         const Eigen::VectorXd& position) const override;
  double Reach() const { return reach_; }  // m

 private:
  std::shared_ptr<const ScanFrames> scans_;
  std::shared_ptr<const Body> body_;
  SurfacePatches patches_;
  double reach_ = 0;  // m
  double depth_ = 0;  // m, depth of the scanned surface below the model's: half a sheet's thickness
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SURFACE_OBSERVER_H_
