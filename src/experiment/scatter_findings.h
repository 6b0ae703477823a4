// What is said about the scatter of a recording's points: a line for everybody, and warnings.
#ifndef LACUNA_EXPERIMENT_SCATTER_FINDINGS_H_
#define LACUNA_EXPERIMENT_SCATTER_FINDINGS_H_

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "experiment/recording_scatter.h"

namespace lacuna {

// What an experiment says about the noise of a recording.
struct StatedNoise {
  double deviation = 0;  // m, σ; 0: the experiment does not give it
  std::string key;       // its key: "noise", "scan.noise", "fit.noise"; empty without an experiment
  double voxel = 0;      // m, width of the cubes whose points are averaged; 0: none are
};

// One line: the typical and the largest scatter, the spacing of the points, the share of outliers
// where points could be judged and how far off these are, and a stated noise that is more than
// three times the scatter. Such a value is no mistake where it stands for errors of the model or
// the registration. Empty where nothing can be said.
std::string DescribeScatter(const RecordingScatter& scatter, const StatedNoise& noise = {});

// Sentences about scatter that is more than three times the stated noise, that exceeds half of the
// spacing of the points, that is three times the typical one in some frame of a scan, and about
// outliers of scans. What is an upper bound is not compared with the stated noise. Each says what
// to write or what to look at.
std::vector<std::string> DoubtsOfScatter(const RecordingScatter& scatter, const StatedNoise& noise);

struct ExaminedRecording {
  std::vector<std::string> findings;  // of ExamineFrames (scan/recording_check.h) and of the above
  std::string scatter;                // DescribeScatter
};

// Reads the frames once for both, until `most_points` rows have been read. Throws what
// ExamineFrames throws.
ExaminedRecording ExamineRecording(const Recording& recording, const StatedNoise& noise = {},
                                   int64_t most_points = std::numeric_limits<int64_t>::max());

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCATTER_FINDINGS_H_
