// The regions of a study as lists of nodes, for predictions of a body whose nodes were moved.
#ifndef LACUNA_CALIBRATION_LISTED_NODES_H_
#define LACUNA_CALIBRATION_LISTED_NODES_H_

#include "calibration/calibration_problem.h"

namespace lacuna {

// The study of the problem, with its estimated noise and with each region of a support, grip, load
// or hold as the list of the nodes of the problem's mesh that it contains. A mesh with the same
// nodes at other places then has the same nodes in each region, even if moving a node takes it out
// of the region's shape, for example a box that ends at a face of the object.
PredictionStudy WithListedNodes(const CalibrationProblem& problem);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_LISTED_NODES_H_
