#include <vector>

#include "exchange/scene_writers.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

// Keeps the entries of `part` whose nodes are kept, with their new numbers; returns their places.
std::vector<int> Keep(const std::vector<int>& kept, NamedNodes* part) {
  std::vector<int> places, nodes;
  for (size_t k = 0; k < part->nodes.size(); ++k) {
    const int node = kept[static_cast<size_t>(part->nodes[k])];
    if (node < 0) continue;
    places.push_back(static_cast<int>(k));
    nodes.push_back(node);
  }
  part->nodes = nodes;
  return places;
}

// Gives half of the share of each midpoint to each end of its edge: displacements that are linear
// along the edge do the same work.
void RestrictLoad(const PortableModel& model, const std::vector<int>& kept, PortableLoad* load) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(model.mesh.NodeCount());
  shares(load->part.nodes) = load->shares;
  for (const auto tet : model.mesh.tets.colwise())
    for (int k = 0; k < 6; ++k) {
      double& middle = shares[tet[4 + k]];  // 0 after its first element
      for (const int end : kTetEdges[static_cast<size_t>(k)]) shares[tet[end]] += middle / 2;
      middle = 0;
    }
  load->part.nodes.clear();
  std::vector<double> left;
  for (Eigen::Index n = 0; n < shares.size(); ++n) {
    if (shares[n] == 0) continue;
    load->part.nodes.push_back(kept[static_cast<size_t>(n)]);
    left.push_back(shares[n]);
  }
  load->shares =
      Eigen::Map<const Eigen::VectorXd>(left.data(), static_cast<Eigen::Index>(left.size()));
}

}  // namespace

PortableModel WithLinearElements(const PortableModel& model) {
  if (model.mesh.Order() == 1) return model;
  PortableModel linear = model;
  std::vector<int> kept(static_cast<size_t>(model.mesh.NodeCount()), -1), nodes;
  for (const int node : model.mesh.tets.topRows<4>().reshaped())
    kept[static_cast<size_t>(node)] = 0;
  for (size_t n = 0; n < kept.size(); ++n) {
    if (kept[n] < 0) continue;
    kept[n] = static_cast<int>(nodes.size());
    nodes.push_back(static_cast<int>(n));
  }
  linear.mesh.nodes = model.mesh.nodes(Eigen::all, nodes);
  linear.mesh.tets = model.mesh.tets.topRows<4>();
  for (int& node : linear.mesh.tets.reshaped()) node = kept[static_cast<size_t>(node)];
  // A quarter of the mass of each element belongs to each of its corners.
  linear.node_mass = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes.size()));
  const Eigen::VectorXd volumes = TetVolumes(linear.mesh);
  for (Eigen::Index e = 0; e < linear.mesh.TetCount(); ++e)
    for (const int node : linear.mesh.tets.col(e))
      linear.node_mass[node] += model.density * volumes[e] / 4;
  for (NamedNodes& region : linear.regions) Keep(kept, &region);
  for (PortableGrip& grip : linear.grips) {
    const std::vector<int> places = Keep(kept, &grip.part);
    for (Eigen::Matrix3Xd& at : grip.displacements) at = Eigen::Matrix3Xd(at(Eigen::all, places));
  }
  for (PortableLoad& load : linear.loads) RestrictLoad(model, kept, &load);
  linear.held_force.resize(3, 0);
  return linear;
}

}  // namespace lacuna
