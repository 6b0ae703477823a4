// What a motion says about the vertices and frames that it was thinned by (record/motion_record.h).
#ifndef LACUNA_RECORD_THINNING_NOTES_H_
#define LACUNA_RECORD_THINNING_NOTES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lacuna {

// Sentences for MotionRecord::notes that say how many of the vertices and frames are kept; none
// where that is all of them.
std::vector<std::string> NotesOnThinning(Eigen::Index vertices, Eigen::Index all_vertices,
                                         Eigen::Index frames, Eigen::Index all_frames);

}  // namespace lacuna

#endif  // LACUNA_RECORD_THINNING_NOTES_H_
