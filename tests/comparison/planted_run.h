// The folder of a made-up run of `lacuna fit` whose prediction errors are chosen, for tests of the
// comparison.
#ifndef LACUNA_TESTS_COMPARISON_PLANTED_RUN_H_
#define LACUNA_TESTS_COMPARISON_PLANTED_RUN_H_

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "record/csv_table.h"

namespace lacuna {

// Four markers at 0, 20, 40 and 60 mm along the x axis rest for 30 frames at 100 Hz, then swing
// along z. The last marker is not seen in every tenth frame. The recordings repeat each other, with
// releases 0.05 s apart; the first 80 frames of the first one are fitted.
struct PlantedRun {
  static constexpr int kMarkers = 4, kFrames = 120, kFittedFrames = 80;
  static constexpr double kNoise = 5e-5;  // m, of a coordinate of a marker

  std::vector<std::string> recordings = {"a"};
  // m, predicted minus measured, without noise.
  std::function<Eigen::Vector3d(int frame, int marker)> error = [](int, int) {
    return Eigen::Vector3d(0, 0, 0);
  };
  // m, the noise of each coordinate of a marker.
  std::function<double(int marker)> noise = [](int) { return kNoise; };
  // Markers swing the more the larger their x, and the second recording has them in the opposite
  // order. Otherwise all of them move alike.
  bool is_mirrored = false;
};

// The error of a run in which marker 2 is predicted a millimetre too low from frame 90 to 109,
// which are held out.
Eigen::Vector3d LowMarker(int frame, int marker);

// Writes the folder of the run. Returns the table of its misfits.
CsvTable WriteRun(const std::filesystem::path& run, const PlantedRun& planted = {});

// Writes experiment.yaml and the recordings that the run in <folder>/run says it was made from. The
// table is that of WriteRun(). `has_second`: with the second recording of a mirrored run.
void WriteExperiment(const std::filesystem::path& folder, const CsvTable& misfit,
                     bool has_second = false);

// Why CompareRun() refuses the folder; empty if it does not.
std::string WhyNotCompared(const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_TESTS_COMPARISON_PLANTED_RUN_H_
