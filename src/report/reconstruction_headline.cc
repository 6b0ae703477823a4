#include "report/reconstruction_headline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/quantity_text.h"

namespace lacuna {
namespace {

const char* HowMoved(RunForces forces) {
  switch (forces) {
    case RunForces::kNone:
      return "Without fitted or recorded forces";
    case RunForces::kKnown:
      return "Under the recorded loads";
    case RunForces::kFitted:
      return "With fitted forces";
  }
  return "";
}

}  // namespace

std::vector<std::string> ReconstructionHeadline(const RunRecord& record) {
  const auto followed = std::count_if(record.frames.begin(), record.frames.end(),
                                      [](const FrameRecord& frame) { return frame.solver.usable; });
  const auto how = [&]() -> std::string {
    if (followed == 0)
      return fmt::format("The model could not follow any of {} frames.", record.FrameCount());
    const std::string follows = fmt::format("{} the model follows {} of {} frames; ",
                                            HowMoved(record.forces), followed, record.FrameCount());
    if (std::isnan(record.relative_animation_residual))
      return follows + "how far its points are from their measured places is not known.";
    return follows +
           fmt::format(
               "its points are {} from their measured places on average{}, {:.2g} % of the "
               "object's size.",
               Millimetres(record.relative_animation_residual * record.object_size),
               std::isnan(record.animation_residual) ? " over the frames in which this was measured"
                                                     : "",
               100 * record.relative_animation_residual);
  };
  if (record.forces != RunForces::kFitted) return {how()};
  return {how(),
          "Forces that are fitted frame by frame let a wrong model follow too, so that this says "
          "nothing about which physics the model lacks."};
}

}  // namespace lacuna
