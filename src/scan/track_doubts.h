// Faults in the tracks of markers that motion-capture systems and their software cause, and that no
// motion of a body does.
#ifndef LACUNA_SCAN_TRACK_DOUBTS_H_
#define LACUNA_SCAN_TRACK_DOUBTS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "scan/marker_tracks.h"

namespace lacuna {

// Sentences about the tracks (m) from `file`:
//   exchanged   each of two markers is where the other was seen last;
//   jumps       a marker moves at once more than five times as far as every other marker and as
//               itself in the frame before, and then stays there or comes back;
//   repeats     a marker keeps its coordinates to the last digit in three or more frames, in which
//               most others do not, more often than by rounding: a gap filled with the last place,
//               or a number such as −9999 that stands for "not seen".
// At least three other markers must be seen in these frames, and move in some, for a jump. Times
// are not read. Each sentence names the markers and frames. Empty where there is no doubt.
std::vector<std::string> DoubtsOfTracks(const MarkerTracks& tracks,
                                        const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TRACK_DOUBTS_H_
