#include "scan/frame_source.h"

#include <utility>

namespace lacuna {
namespace {

// The name of each kind with an empty source of it, in the order of the variant.
template <size_t... I>
std::vector<std::pair<std::string, FrameSource>> EmptySources(std::index_sequence<I...>) {
  return {
      {std::variant_alternative_t<I, FrameSource>::kKind, FrameSource(std::in_place_index<I>)}...};
}

}  // namespace

FrameSource ReadFrameSource(const Config& frames, const DataLocation& data,
                            std::vector<std::string>* warnings) {
  FrameSource source = frames.Choice<FrameSource>(
      "kind", EmptySources(std::make_index_sequence<std::variant_size_v<FrameSource>>()));
  std::visit([&](auto& kind) { ReadSource(frames, data, &kind, warnings); }, source);
  return source;
}

}  // namespace lacuna
