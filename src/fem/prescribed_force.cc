#include "fem/prescribed_force.h"

#include <glog/logging.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lacuna {

Eigen::VectorXd BoundaryShares(const Body& body, const Eigen::VectorXi& nodes) {
  const BoundarySurface& boundary = body.boundary;
  std::vector<char> chosen(body.NodeCount(), 0);
  for (const int node : nodes) chosen[node] = 1;
  const auto all_chosen = [&](const auto& of) {
    return std::all_of(of.begin(), of.end(), [&](int node) { return chosen[node] != 0; });
  };
  const Eigen::VectorXd areas = TriangleAreas(boundary.surface);
  const Eigen::Index per_face = areas.size() / boundary.faces.cols();
  Eigen::VectorXd share = Eigen::VectorXd::Zero(body.NodeCount());
  for (Eigen::Index f = 0; f < boundary.faces.cols(); ++f) {
    const auto face = boundary.faces.col(f);
    const Eigen::Index first = f * per_face;
    if (all_chosen(face)) {
      // ∫ N_a dA vanishes at the corners of a straight-sided quadratic face.
      share(face.tail<3>()).array() += areas.segment(first, per_face).sum();
      continue;
    }
    for (Eigen::Index t = first; t < first + per_face; ++t) {
      const Eigen::Vector3i corner = boundary.node(boundary.surface.triangles.col(t));
      if (all_chosen(corner)) share(corner).array() += areas[t];
    }
  }
  if (share.sum() == 0) share(nodes) = NodeBoundaryAreas(body)(nodes);
  CHECK_GT(share.sum(), 0) << "a force on nodes without boundary area";
  return share / share.sum();
}

PrescribedForce::PrescribedForce(Eigen::VectorXd share,
                                 std::function<Eigen::Vector3d(double)> force)
    : share_(std::move(share)), force_(std::move(force)) {}

const EffectCard& PrescribedForce::Card() const {
  static const EffectCard card{
      .type = "prescribed_force",
      .title = "Known external force",
      .equation = "f_i = gain · share_i · F(t)",
      .citation = "measured during the recording",
      .parameters = {{.name = "gain",
                      .meaning = "true force divided by the measured force",
                      .dimension = kDimensionless,
                      .bounds = kAnyValue,
                      .null_value = 0,
                      .plausible_min = 0.8,
                      .plausible_max = 1.25,
                      .default_value = 1,
                      .log_scale = false}},
      .residual_when_missing =
          "the model does not respond when the load changes; the unexplained force lies where the "
          "load acts and has its size and direction",
      .separating_experiment = "remove the load: an error that remains has another cause",
      .look_alikes = {},
      .conserves_momentum = false,
      .conserves_angular_momentum = false};
  return card;
}

void PrescribedForce::AddForce(const Kinematics& at, Eigen::VectorXd* force) const {
  CHECK_EQ(share_.size(), at.body.NodeCount());
  force->reshaped(3, share_.size()) += gain_ * force_(at.time) * share_.transpose();
}

void PrescribedForce::AddParameterDerivative(const Kinematics& at, int parameter,
                                             Eigen::VectorXd* derivative) const {
  CHECK_EQ(parameter, 0);
  derivative->reshaped(3, share_.size()) += force_(at.time) * share_.transpose();
}

std::optional<double> PrescribedForce::Energy(const Kinematics& at) const {
  const auto displacement = at.position.reshaped(3, share_.size()) - at.body.mesh.nodes;
  return -gain_ * force_(at.time).dot(displacement * share_);
}

}  // namespace lacuna
