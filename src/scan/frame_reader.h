// The frames of a recording, as its YAML tells them.
#ifndef LACUNA_SCAN_FRAME_READER_H_
#define LACUNA_SCAN_FRAME_READER_H_

#include <string>
#include <vector>

#include "core/config.h"
#include "scan/recording.h"

namespace lacuna {

// Reads the mapping `frames` into `recording`, whose data_folder and length_unit are known: kind,
// files, times, cameras or markers. Returns the times of all frames in the files, s, chosen or not.
std::vector<double> ReadFrames(const Config& frames, Recording* recording);

// Logs the message and keeps it among the recording's warnings.
void Warn(Recording* recording, const std::string& message);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_READER_H_
