// Stage 7 of Transue & Choi 2015: measures of how well the model follows the recording, and files
// that show it.
#ifndef LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_
#define LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"
#include "record/run_record.h"

namespace lacuna {

// Computes |D| (Eq. 1) and distances for each frame, |D_anim| (Eq. 2), and the errors against
// held-out points and known truths where the study names them. Frames in which D was not measured
// have no |D|; a warning says how many there are. |D_anim| is measured only where all frames were
// followed and D was measured in all of them after the reference, because a sum without some frames
// would be too small. The warnings include the notes on the states. RunRecord::measures contains,
// besides the values of the frames:
//   noise_m                        σ of a scanned point, or of a coordinate of a point that
//                                  identifies itself, as used by the fit; absent where no forces
//                                  were fitted
//   residual_frames                number of frames after the reference in which D was measured
//   residual_per_point_m           mean of |D| per point over these frames
//   surface_distance_mean_m        mean over the frames after the reference
//   held_out_points                number of held-out points that were compared with the model in
//                                  some frame
//   held_out_rms_max_m             largest rms error of the held-out points in a frame; absent if
//                                  none was compared
//   held_out_spacing_m             mean distance of all tracked points to the nearest other one on
//                                  the undeformed body; absent where none was compared, and where
//                                  fewer than two of these places are known
//   true_surface_distance_mean_m   mean distance of the true surface's vertices from the simulated
//                                  surface over all frames after the reference
//   true_surface_distance_max_m    the same for the worst frame
//   true_position_mean_error_m     mean error of the true points
//   true_displacement_max_m        their largest displacement
//   true_position_mean_error       the ratio of both; absent where the points do not move
//   true_force_median_error        median over the frames of |F − F_true| / |F_true|
// Throws InputError where the files of the known truths cannot be used (known_answers.h).
RunRecord MeasureRun(const ReconstructionStudy& study, const ReferenceBody& reference,
                     const std::vector<FrameState>& states, const FollowedMotion& motion);

// Writes to `folder` the frames that were followed, as three time series whose files are in
// <folder>/fields:
//   body.pvd      the deformed mesh: displacement_m, force_N and pseudo_force_N (FollowedFrame) at
//                 the nodes;
//   surface.pvd   its boundary: residual_m (D) and residual_length_m at the vertices, NaN where D
//                 was not measured;
//   scan.pvd      the scanned points: distance_to_model_m, to the nearest point of the boundary.
// last_frame.png shows the boundary in the last frame that was followed, coloured by the length of
// D, and the scanned points; it is not written if no frame was followed, and a picture that cannot
// be drawn is a warning. Throws InputError where a file cannot be written.
void WriteFields(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                 const FollowedMotion& motion, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_
