// The variables by which a recording's misfit is differentiated.
#ifndef LACUNA_PREDICTION_MISFIT_DIRECTION_H_
#define LACUNA_PREDICTION_MISFIT_DIRECTION_H_

#include <cstddef>
#include <functional>

#include "fem/tangent_linear.h"

namespace lacuna {

// The variable by which one column of a Misfit's Jacobian is the derivative.
struct MisfitDirection {
  // A parameter of the model, or a nuisance parameter of the recording: the delay, s, of its clock,
  // the translation, m, or rotation, rad, of its coordinate system along or about an axis, the
  // delay, s, of one of its load cells behind the frames, or the translation, m, or rotation, rad,
  // of a grip along or about an axis (grip_placement.h).
  enum class Kind { kModel, kClock, kShift, kTurn, kCellDelay, kGripShift, kGripTurn };
  Kind kind = Kind::kModel;
  int axis = 0;                    // for kShift, kTurn, kGripShift and kGripTurn: 0, 1 or 2
  Perturbation perturbation = {};  // for kModel
  // For kModel, in place of `perturbation`: one that depends on the recording in which it is
  // simulated. It is made for the recording's model, with the grips at their fitted placements.
  std::function<Perturbation(const Model& placed)> perturbation_in = {};
  size_t grip = 0;     // for kGripShift and kGripTurn: its index in Model::grips
  size_t reading = 0;  // for kCellDelay: its index in RecordingModel::Reactions()

  bool IsOfGrip() const { return kind == Kind::kGripShift || kind == Kind::kGripTurn; }
  // Whether the derivative is that of the simulation. All others follow from the motion.
  bool IsSimulated() const { return kind == Kind::kModel || IsOfGrip(); }
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_MISFIT_DIRECTION_H_
