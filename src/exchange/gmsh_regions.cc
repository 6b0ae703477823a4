#include "exchange/gmsh_regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "exchange/counterpart.h"

namespace lacuna {

std::string GmshRegions(const PortableModel& model) {
  std::string text;
  const auto end = std::back_inserter(text);
  for (const NamedNodes& region : model.regions) {
    std::string name = CommentText(region.name);
    std::replace(name.begin(), name.end(), '"', '\'');
    // One text, the name; one real number, the time; three integers: the time step, the number of
    // components and the number of nodes.
    fmt::format_to(end, "$NodeData\n1\n\"{}\"\n1\n0\n3\n0\n1\n{}\n", name, model.mesh.NodeCount());
    for (int node = 0; node < model.mesh.NodeCount(); ++node)
      fmt::format_to(end, "{} {}\n", node + 1,
                     std::binary_search(region.nodes.begin(), region.nodes.end(), node) ? 1 : 0);
    text += "$EndNodeData\n";
  }
  return text;
}

}  // namespace lacuna
