#include "experiment/observer.h"

#include "experiment/subset_rows.h"
#include "geometry/embedding.h"

namespace lacuna {

MarkerObserver::MarkerObserver(const Recording& recording, const TetMesh& mesh)
    : recording_(recording), mesh_(mesh), places_(Embed(mesh, recording.markers.places)) {
  if (recording.instrument.subset > 0) {
    rows_ = std::make_shared<const ObservationMatrix>(
        SubsetRows(mesh, recording.markers.places, recording.instrument));
    return;
  }
  ObservationMatrix rows;
  for (Eigen::Index m = 0; m < places_.tet.size(); ++m) {
    for (int axis = 0; axis < 3; ++axis) {
      for (Eigen::Index a = 0; a < places_.weight.rows(); ++a) {
        rows.column.push_back(3 * mesh.tets(a, places_.tet[m]) + axis);
        rows.weight.push_back(places_.weight(a, m));
      }
      rows.begin.push_back(static_cast<int>(rows.column.size()));
    }
  }
  rows_ = std::make_shared<const ObservationMatrix>(std::move(rows));
}

std::vector<Eigen::Matrix3d> MarkerObserver::DeformationAt(const Eigen::VectorXd& position) const {
  std::vector<Eigen::Matrix3d> deformation;
  const auto nodes = position.reshaped(3, mesh_.NodeCount());
  for (Eigen::Index m = 0; m < places_.tet.size(); ++m)
    deformation.push_back(DeformationGradientAt(places_, m, mesh_, nodes));
  return deformation;
}

Observed MarkerObserver::ObserveWithin(double /*reach_factor*/, int frame,
                                       const Eigen::VectorXd& position) const {
  Observed observed;
  observed.rows = rows_;
  observed.deformation = DeformationAt(position);
  observed.measured = recording_.markers.positions[frame];
  observed.target = observed.measured.reshaped();
  observed.count.resize(observed.measured.cols());
  const std::vector<Eigen::VectorXd>& weights = recording_.markers.weights;
  for (Eigen::Index m = 0; m < observed.count.size(); ++m) {
    const bool is_seen = observed.measured.col(m).allFinite();
    observed.count[m] = is_seen ? (weights.empty() ? 1 : weights[frame][m]) : 0;
    observed.used += is_seen;
  }
  observed.offered = observed.used;
  return observed;
}

}  // namespace lacuna
