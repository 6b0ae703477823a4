// What measures the bar of a sealed case, and the recording that comes of it: a motion-capture
// system with markers whose noise is correlated in time, or four noisy depth cameras.
#ifndef LACUNA_TRIALS_TRIAL_RECORDING_H_
#define LACUNA_TRIALS_TRIAL_RECORDING_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <vector>

#include "fem/body.h"
#include "trials/trial_case.h"

namespace lacuna {

inline constexpr int kTrialFrames = 60;
inline constexpr double kTrialSpacing = 0.01;     // s
inline constexpr double kTrialDensity = 1000;     // kg/m³
inline constexpr double kTrialFace = 1e-5;        // m: clamp and hand hold the faces at the ends
inline constexpr double kTrialPlaceError = 1e-4;  // m, per axis, of what is told of a marker
inline constexpr double kTrialShapeError = 2e-4;  // m, of a body that is 0.2 % off

// The true bar in every frame.
struct FilmedMotion {
  std::shared_ptr<const Body> body;
  std::vector<Eigen::Matrix3Xd> positions;  // of its nodes, m
};

// Draws from the case's seed: number (i, j) of a stream, normally distributed.
double Gauss(const TrialCase& trial, uint64_t stream, uint64_t i, uint64_t j);

// Writes recording.yaml and all that it names. Throws InputError where that fails.
void WriteRecording(const TrialCase& trial, int recording, const FilmedMotion& motion,
                    const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_RECORDING_H_
