// Writes predicted and measured motion as fields that ParaView opens.
#ifndef LACUNA_COMPARISON_COMPARISON_FIELDS_H_
#define LACUNA_COMPARISON_COMPARISON_FIELDS_H_

#include <filesystem>

#include "comparison/unexplained_force.h"
#include "prediction/replayed_motion.h"
#include "record/recorded_residuals.h"

namespace lacuna {

// At most this many of the states of a replayed motion are written. They are evenly spread and
// include the first and the last one. Larger: smoother animations, more disk space.
inline constexpr int kMostFieldFrames = 60;

// Writes two time series to `folder`, and the files that they list to <folder>/fields:
//   body.pvd     the predicted mesh: displacement_m, velocity_m_per_s, cauchy_stress_Pa (nine
//                components, row by row), von_mises_stress_Pa, principal_stretches (the largest
//                first; nodal_recovery.h) and unexplained_force_N_per_m3 (if usable) at the nodes;
//                strain, the largest principal Green–Lagrange strain, in the tetrahedra;
//   markers.pvd  the measured markers: predicted_m, difference_m,
//                difference_over_sigma (`over_noise`, m × n: LengthsOverNoise()), fitted, marker.
//                Markers that were not observed are left out;
//   patches.pvd  for scans, in place of markers.pvd: each observed patch at the mean of its scanned
//                points, with predicted_m, difference_m and difference_over_sigma along its normal,
//                fitted, patch, and along_normal_m, the difference with its sign: positive where
//                the prediction lies outside of the scan.
// All are in the recording's coordinate system. Returns the number of frames. Throws InputError
// when a file cannot be written.
int WriteComparisonFields(const RecordingModel& model, const RecordedResiduals& residuals,
                          const ReplayedMotion& motion, const UnexplainedForce& force,
                          const Eigen::MatrixXd& over_noise, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARISON_FIELDS_H_
