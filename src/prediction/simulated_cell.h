// The systematic errors of a load cell where a recording is played: a constant offset and a delay.
// They are what `tare_deviation` and `delay_deviation` are the priors of
// (scan/measured_reaction.h).
#ifndef LACUNA_PREDICTION_SIMULATED_CELL_H_
#define LACUNA_PREDICTION_SIMULATED_CELL_H_

#include <Eigen/Core>
#include <vector>

#include "core/config.h"
#include "scan/measured_reaction.h"

namespace lacuna {

struct SimulatedCell {
  // N, or N m of a torque; component i of a reading has the offset directions_i · tare.
  Eigen::Vector3d tare = Eigen::Vector3d::Zero();
  double delay = 0;  // s, at least 0: a reading that is stamped t is that of t − delay
};

// The cells of the readings, one for each, from the entry of a recording:
//   simulated_cells:
//     - {part: jaw, measures: force, tare: [0.1 N, 0, 0], delay: 5 ms}
// Without an error where there is none; empty where there is no such key, which then leaves no
// trace in Config::Resolved(). Throws InputError (file, line, column and field).
std::vector<SimulatedCell> ReadSimulatedCells(const Config& recording,
                                              const std::vector<MeasuredReaction>& readings);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_SIMULATED_CELL_H_
