#include "reconstruction/force_model_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace lacuna {

ForceModel MakeForceModel(const ReconstructionStudy& study, const Model& grips_and_body) {
  const ForceSettings& settings = study.follow.forces;
  const Body& body = *grips_and_body.body;
  const std::vector<char> gripped = GrippedNodes(grips_and_body);
  std::vector<char> selectable(body.NodeCount(), 0);
  for (const int node : body.boundary.node) selectable[node] = !gripped[node];
  std::vector<int> nodes;
  if (settings.region) {
    nodes = NamingWhere(study.name + ": forces.region",
                        [&] { return SelectNodes(*settings.region, body.mesh); });
  } else {
    nodes.assign(body.boundary.node.begin(), body.boundary.node.end());
  }
  std::erase_if(nodes, [&](int node) { return !selectable[node]; });
  if (nodes.empty() && settings.AreFitted()) {
    throw InputError(fmt::format("{}: forces: no free node of the boundary {}", study.name,
                                 settings.region
                                     ? "is in their region"
                                     : "is left: the recording's grips hold all of them"));
  }
  const Eigen::VectorXi where =
      Eigen::Map<const Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
  ForceModel model = NoForces(body);
  switch (settings.kind) {
    case ForceSettings::Kind::kNone:
    case ForceSettings::Kind::kKnown:
      break;
    case ForceSettings::Kind::kFree:
      model = FreeForces(body, where);
      break;
    case ForceSettings::Kind::kFootprint:
      model = FootprintForce(body, where, settings.force_scale);
      break;
    case ForceSettings::Kind::kNodal:
      model = NodalForces(body, where, settings.force_scale);
      break;
    case ForceSettings::Kind::kSmooth: {
      const double size = BoundingBoxDiagonal(body.mesh.nodes);
      const double young_modulus = study.effects.front()->Parameters()[0];
      model =
          SmoothForces(body, where, settings.length > 0 ? settings.length : 0.25 * size,
                       settings.traction_scale > 0 ? settings.traction_scale : 0.1 * young_modulus);
      break;
    }
  }
  if (settings.hold_net_force) model = HoldNetForceAndTorque(body, model);
  if (settings.AreFitted() && !model.HasUnknowns())
    throw InputError(fmt::format(
        "{}: forces.hold_net_force: the forces on the {} free node{} of the boundary have no "
        "combination without a net force and a net torque, so that none can be fitted",
        study.name, nodes.size(), nodes.size() == 1 ? "" : "s"));
  return model;
}

}  // namespace lacuna
