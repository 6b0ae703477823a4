// Compares one predicted frame with what was measured in it: the rows that it adds to a Misfit.
#ifndef LACUNA_PREDICTION_COMPARED_FRAME_H_
#define LACUNA_PREDICTION_COMPARED_FRAME_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "experiment/observer.h"
#include "prediction/misfit.h"
#include "prediction/misfit_direction.h"
#include "prediction/recording_model.h"

namespace lacuna {

// The motion of the n nodes in one frame, node-major.
struct NodalMotion {
  Eigen::VectorXd position, velocity;  // 3n, m and m/s
  Eigen::MatrixXd jacobian;  // 3n × k: ∂position/∂(direction) of the k simulated directions
  bool moves = false;        // false up to the start, before which a delay changes nothing

  // Transforms it from the model's to the recording's coordinates.
  void Register(const Eigen::Isometry3d& registration);
};

// A misfit without frames, with space for this number of them, and for the reactions.
Misfit EmptyMisfit(const RecordingModel& model, size_t frames, size_t directions);

// Writes the next frame of a misfit, whose space EmptyMisfit() has reserved. `frame` is its number
// in the recording, `nodal` is in the recording's coordinates, and `seen` is what it is compared
// with. Rows of points that were not seen are 0.
void AppendFrame(const RecordingModel& model, const std::vector<MisfitDirection>& directions,
                 const Eigen::Isometry3d& registration, int frame, const NodalMotion& nodal,
                 Observed seen, Misfit* misfit);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_COMPARED_FRAME_H_
