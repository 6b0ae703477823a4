// What acts on the object of a recording from outside, as its YAML tells it: grips and forces.
#ifndef LACUNA_SCAN_KNOWN_FORCES_H_
#define LACUNA_SCAN_KNOWN_FORCES_H_

#include <vector>

#include "core/config.h"
#include "scan/recording.h"

namespace lacuna {

// The items of `gripped`: a region and how it moves: `follows: scan` (the default),
// `follows_markers: [..]`, or `path: {file, time, x, y, z, time_unit, length_unit}` with one row
// per moment (columns by name or number), the first one at the undeformed place; with
// `turn: {x, y, z, unit, about}` in the path, three more columns of the same file are a rotation
// vector. `deforms: true`: what follows stretches as well. `file_times` are those of all frames in
// the files, also of the ones that were not chosen.
std::vector<RecordedGrip> ReadGrips(const Config& config, const Recording& recording,
                                    const std::vector<double>& file_times);

// The items of `forces`: `constant: [..]`, or `file` (.npy or text) with `unit` and either `time`
// among its columns or one row per frame, and optionally `region`.
std::vector<MeasuredForce> ReadForces(const Config& config, const Recording& recording,
                                      const std::vector<double>& file_times);

}  // namespace lacuna

#endif  // LACUNA_SCAN_KNOWN_FORCES_H_
