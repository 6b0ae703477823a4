// The size of nuisances that have columns for each single frame.
//
// Each of these columns has entries for all frames, so that their size grows with the square of the
// number of frames, whereas most entries are 0.
#ifndef LACUNA_DIAGNOSIS_SINGLE_FRAME_COLUMNS_H_
#define LACUNA_DIAGNOSIS_SINGLE_FRAME_COLUMNS_H_

#include <Eigen/Core>
#include <string>

namespace lacuna {

// The columns of one nuisance, for all recordings together, have at most this many entries. Higher:
// longer recordings keep the nuisance, whose columns the ranking copies several times.
inline constexpr double kMostSingleFrameEntries = 1e8;

// Why columns of this size are not made, for NuisanceCandidate::untried; empty: they are.
std::string WhyTooLarge(Eigen::Index rows, Eigen::Index columns);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SINGLE_FRAME_COLUMNS_H_
