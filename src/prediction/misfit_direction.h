// The variables by which a recording's misfit is differentiated.
#ifndef LACUNA_PREDICTION_MISFIT_DIRECTION_H_
#define LACUNA_PREDICTION_MISFIT_DIRECTION_H_

#include "fem/tangent_linear.h"

namespace lacuna {

// The variable by which one column of a Misfit's Jacobian is the derivative.
struct MisfitDirection {
  // A parameter of the model, or a nuisance parameter of the recording: the delay, s, of its clock,
  // the translation, m, or rotation, rad, of its coordinate system along or about an axis, or the
  // delay, s, of one of its load cells behind the frames.
  enum class Kind { kModel, kClock, kShift, kTurn, kCellDelay };
  Kind kind = Kind::kModel;
  int axis = 0;                    // kCellDelay: the number of the reading
  Perturbation perturbation = {};  // for kModel
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_MISFIT_DIRECTION_H_
