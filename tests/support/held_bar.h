// A soft bar that is held aside, let go and filmed by a motion-capture system: what a prediction
// study of markers explains. Made with a finer mesh and smaller steps than the study's.
#ifndef LACUNA_TESTS_SUPPORT_HELD_BAR_H_
#define LACUNA_TESTS_SUPPORT_HELD_BAR_H_

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "prediction/prediction_study.h"
#include "support/box_mesh.h"

namespace lacuna {

struct HeldBarTruth {
  double young_modulus = 1e5;                 // Pa
  double alpha = 2;                           // 1/s, of mass_damping
  Eigen::Vector3d hold_force{0, 0.05, 0.02};  // N
  double clock = 0.003;                       // s, by which the recording runs late
  double jitter = 0;                          // s, by which frames are early or late at most
  double noise = 5e-5;                        // m
  // N, over time: a net force spread over the bar by mass, that a model may lack.
  std::function<Eigen::Vector3d(double time)> body_force = {};
  std::string law = "neo_hookean";
  std::vector<std::shared_ptr<const Effect>> hidden = {};  // that a model may lack too
};
inline constexpr double kRelease = 0.0437;   // s
inline constexpr double kFitUntil = 0.1501;  // s
inline constexpr int kFrames = 26;           // at 100 Hz
inline constexpr int kMarkers = 8;

inline TetMesh BarMesh(const std::array<int, 3>& cells, int order) {
  return BoxMesh({0, -0.01, -0.01}, {0.08, 0.01, 0.01}, cells, order);
}

Eigen::Matrix3Xd BarMarkerPlaces();

// Positions of the markers in all frames.
std::vector<Eigen::Matrix3Xd> FilmHeldBar(const HeldBarTruth& truth);

// The bar's shape, as an OFF file.
void WriteBox(const std::filesystem::path& file);

// Writes recording.yaml, markers.csv, load.csv and box.off.
void WriteBarRecording(const std::filesystem::path& folder,
                       const std::vector<Eigen::Matrix3Xd>& markers);

// An experiment on the recording in `folder`, with texts replaced.
std::string BarExperiment(const std::filesystem::path& folder,
                          const std::map<std::string, std::string>& replaced = {});
PredictionStudy ReadBarStudy(const std::filesystem::path& folder,
                             const std::map<std::string, std::string>& replaced = {});

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_HELD_BAR_H_
