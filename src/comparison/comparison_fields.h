// The comparison as ParaView opens it.
#ifndef LACUNA_COMPARISON_COMPARISON_FIELDS_H_
#define LACUNA_COMPARISON_COMPARISON_FIELDS_H_

#include <filesystem>

#include "comparison/comparison.h"
#include "comparison/unexplained_force.h"
#include "prediction/replayed_motion.h"

namespace lacuna {

// Frames of a recording that are written, at most: of those that the replayed motion keeps, every
// k-th, counted back from the last, with the smallest k that leaves so few.
inline constexpr int kMostFieldFrames = 60;

// <folder>/body.pvd with the predicted mesh (displacement_m, velocity_m_per_s,
// unexplained_force_N_per_m3 at the nodes; strain, the largest principal Green–Lagrange strain of
// each tetrahedron) and <folder>/markers.pvd with the measured markers that were seen (predicted_m,
// difference_m, difference_in_noise, fitted, marker), files under <folder>/fields, of the frames in
// motion; both in the recording's measuring frame. Returns how many.
int WriteComparisonFields(const RecordingModel& model, const ComparedRecording& recording,
                          const ReplayedMotion& motion, double noise,
                          const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARISON_FIELDS_H_
