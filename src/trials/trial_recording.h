// The measurement of the bar of a sealed case: a motion-capture system with eight markers, whose
// noise is correlated in time, or four depth cameras with noise along their rays.
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
inline constexpr double kTrialDensity = 1000;     // kg/m³
inline constexpr double kTrialFace = 1e-5;        // m: the clamp and the hand hold the nodes within
                                                  // this distance of the end faces
inline constexpr double kTrialPlaceError = 1e-4;  // m: standard deviation, per axis, of the
                                                  // recorded place of a marker
inline constexpr double kTrialShapeError = 2e-4;  // m: shape deviation for a size error of 0.2 %

// The motion of the true bar.
struct TrueMotion {
  std::shared_ptr<const Body> body;
  std::vector<Eigen::Matrix3Xd> positions;  // for each frame: 3 × nodes, m
  Eigen::Matrix3Xd forces;  // 3 × cell times (TrialProcedure), N, of the clamp on the bar
};

// The places of the eight markers on the surface of a bar of this size: 3 × markers, m.
Eigen::Matrix3Xd MarkerPlaces(const Eigen::Vector3d& size);

// By how much the recorded place of a marker is off, m.
Eigen::Vector3d PlaceError(const TrialCase& trial, Eigen::Index marker);

// What a motion-capture system sees of the points at `places` (3 × markers, m) on the true bar, in
// each frame of the motion, with noise. `recording` is the number of the recording in its case.
std::vector<Eigen::Matrix3Xd> SeenMarkers(const TrialCase& trial, int recording,
                                          const TrueMotion& motion, const Eigen::Matrix3Xd& places);

// The times with which the frames of a case's own recordings are stamped, s.
std::vector<double> StampedTimes();

// Writes recording.yaml and all files that it refers to into the folder. `recording` is 0 or 1.
// Throws InputError if a file cannot be written.
void WriteRecording(const TrialCase& trial, int recording, const TrueMotion& motion,
                    const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_RECORDING_H_
