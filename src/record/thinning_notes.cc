#include "record/thinning_notes.h"

#include <fmt/format.h>

namespace lacuna {

std::vector<std::string> NotesOnThinning(Eigen::Index vertices, Eigen::Index all_vertices,
                                         Eigen::Index frames, Eigen::Index all_frames) {
  std::vector<std::string> notes;
  if (vertices < all_vertices)
    notes.push_back(
        fmt::format("The surface is drawn with {} of its {} vertices.", vertices, all_vertices));
  if (frames < all_frames)
    notes.push_back(fmt::format("{} of {} frames are drawn.", frames, all_frames));
  return notes;
}

}  // namespace lacuna
