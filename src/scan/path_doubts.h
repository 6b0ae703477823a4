// Doubts about the path of a grip that moves along a given one: sentences about what a logger or a
// wrong unit causes.
#ifndef LACUNA_SCAN_PATH_DOUBTS_H_
#define LACUNA_SCAN_PATH_DOUBTS_H_

#include <string>

#include "scan/recorded_grip.h"

namespace lacuna {

// About a turn that the file gives in rad: more than a full turn, which degrees would look like,
// and columns called like the components of a quaternion or like Euler angles. Empty if there is
// none.
std::string DoubtOfTurn(const RecordedGrip& grip);

// About an interval without a row, between the times `first` and `last` (s) of the frames, that is
// more than ten times the usual one and in which the grip moves by more than a twentieth of its
// range. Empty if there is none, and where such intervals are frequent, as where a path has rows
// only where its velocity changes.
std::string DoubtOfGap(const RecordedGrip& grip, double first, double last);

// About two neighbouring rows, not after `last` (s), that are farther apart than the object's
// `size` (m), as where a logger writes zeros before it is ready. Empty if there are none.
std::string DoubtOfJump(const RecordedGrip& grip, double size, double last);

}  // namespace lacuna

#endif  // LACUNA_SCAN_PATH_DOUBTS_H_
