#include "experiment/known_loads.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "fem/prescribed_force.h"

namespace lacuna {

EffectList MakeKnownForces(const Recording& recording, const Model& grips_and_body) {
  EffectList loads;
  const Body& body = *grips_and_body.body;
  const Eigen::VectorXd areas = NodeBoundaryAreas(body);
  const std::vector<char> gripped = GrippedNodes(grips_and_body);
  for (const MeasuredForce& force : recording.object.forces) {
    const std::string where = recording.file.string() + ": " + force.name;
    std::vector<int> nodes =
        NamingWhere(where, [&] { return SelectNodes(*force.region, body.mesh); });
    std::erase_if(nodes, [&areas](int node) { return areas[node] == 0; });
    if (nodes.empty())
      throw InputError(where + " acts on no boundary node: its region is too small");
    if (std::all_of(nodes.begin(), nodes.end(), [&](int node) { return gripped[node]; }))
      throw InputError(where + " acts only on nodes that are held, where it has no effect");
    const Eigen::VectorXi chosen =
        Eigen::Map<const Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
    loads.push_back(std::make_shared<PrescribedForce>(
        BoundaryShares(body, chosen), [force](double time) { return ForceAt(force, time); }));
  }
  return loads;
}

}  // namespace lacuna
