#include "experiment/held_parts.h"

#include <fmt/format.h>

#include <array>
#include <set>
#include <variant>

#include "core/error.h"
#include "experiment/model_reader.h"

namespace lacuna {
namespace {

// `inside`: the number of nodes in the part.
void RequireFreeNodes(const HeldPart& part, Eigen::Index inside, const TetMesh& mesh) {
  if (!part.axes.IsAll() || inside < mesh.NodeCount()) return;
  const bool is_half_space = std::holds_alternative<HalfSpaceRegion>(part.region.shape);
  throw InputError(
      fmt::format("region \"{}\" holds all {} nodes of the body, so that nothing can move{}",
                  part.region.name, mesh.NodeCount(),
                  is_half_space ? " (a half_space is the side to which its `normal` points)" : ""));
}

// The first part that holds each component.
class Holders {
 public:
  explicit Holders(Eigen::Index nodes) : first_(static_cast<size_t>(nodes)) {}

  void Add(const HeldPart& part, int node) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!part.axes.Has(axis)) continue;
      const HeldPart*& first = first_[static_cast<size_t>(node)][static_cast<size_t>(axis)];
      if (first == nullptr) {
        first = &part;
        ++held_;
      } else if (!MayShare(*first) || !MayShare(part)) {
        throw InputError(fmt::format("regions \"{}\" and \"{}\" hold the same part of the object",
                                     first->region.name, part.region.name));
      }
    }
    if (held_ == 3 * first_.size())
      throw InputError(
          fmt::format("region \"{}\" and those before it hold all {} nodes of the body, "
                      "so that nothing can move",
                      part.region.name, first_.size()));
  }

 private:
  static bool MayShare(const HeldPart& part) { return part.axes.IsPartial() && !part.moves; }

  std::vector<std::array<const HeldPart*, 3>> first_;
  size_t held_ = 0;  // components
};

}  // namespace

std::vector<Eigen::VectorXi> NodesOfParts(const std::vector<HeldPart>& parts, const TetMesh& mesh) {
  std::vector<Eigen::VectorXi> inside;
  std::set<int> whole;  // nodes that a part holds along all axes
  for (const HeldPart& part : parts) {
    inside.push_back(NodesIn(part.region, mesh));
    RequireFreeNodes(part, inside.back().size(), mesh);
    if (part.axes.IsAll()) whole.insert(inside.back().begin(), inside.back().end());
  }
  Holders holders(mesh.NodeCount());
  std::vector<Eigen::VectorXi> held;
  for (size_t k = 0; k < parts.size(); ++k) {
    std::vector<int> own;
    for (const int node : inside[k]) {
      if (!parts[k].axes.IsAll() && whole.contains(node)) continue;
      holders.Add(parts[k], node);
      own.push_back(node);
    }
    if (own.empty())
      throw InputError(fmt::format("region \"{}\": other regions hold all its nodes along all axes",
                                   parts[k].region.name));
    held.emplace_back(
        Eigen::Map<const Eigen::VectorXi>(own.data(), static_cast<Eigen::Index>(own.size())));
  }
  return held;
}

}  // namespace lacuna
