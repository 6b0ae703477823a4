// Unit motions of the grips, which are simulated along the fitted trajectory together with the
// effects. Nuisances of grips are combinations of the changes that these motions cause.
//
// With x(t) the position at which a grip holds a node at time t, c(t) the mean of these over the
// grip, X the rest position of the node and X̄ the mean of those, a grip moves its nodes by
//   shift eᵢ, rotation eᵢ × (x − c)          (misplaced grip; 6 directions)
//   −F, −M × (x − c)                          (compliant grip; 2 directions)
//   (X − X̄)ⱼ eᵢ                               (deforming grip; 9 directions, i fastest)
// where F and M = Σ (x − c) × f are the resultant force and moment of the grip's reaction. x
// contains the fitted placement (prediction/grip_placement.h), and is X for a clamp without one.
// Components along axes along which the grip does not hold are 0.
//
// Recordings share a grip if it holds the same nodes along the same axes in them: its unknown
// amounts are then the same, while it holds these nodes where each recording says. A grip that only
// some recordings have changes nothing in the others.
#ifndef LACUNA_DIAGNOSIS_GRIP_MOTIONS_H_
#define LACUNA_DIAGNOSIS_GRIP_MOTIONS_H_

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "prediction/misfit_direction.h"

namespace lacuna {

// The largest of the numbers that were added. Threads may add at the same time.
class LargestNorm {
 public:
  void Add(double norm) {
    double largest = largest_;
    while (norm > largest && !largest_.compare_exchange_weak(largest, norm)) continue;
  }
  double Value() const { return largest_; }  // 0: nothing was added

 private:
  std::atomic<double> largest_ = 0;
};

struct GripMotions {
  struct Grip {
    // Its index in Model::grips, by the index of each fitted recording that has it; not empty.
    std::map<size_t, size_t> index_in;
    // "the grip", or "grip 2" if there are several; with the name of its first recording where not
    // all fitted recordings have it.
    std::string label;
    Eigen::Index rigid = 0;     // the first of 6 directions: per m and per rad
    Eigen::Index yielding = 0;  // the first of 2 directions: per m/N and per rad/(N m)
    Eigen::Index strain = -1;   // the first of 9 directions, per unit strain; −1: does not deform
    // The largest force, N, and moment, N m, in all simulations of the directions.
    std::shared_ptr<LargestNorm> force, moment;

    // Its index in Model::grips of a recording; none where the recording does not have it.
    std::optional<size_t> In(size_t recording) const;
  };
  std::vector<Grip> grips;  // those that hold nodes
  std::vector<MisfitDirection> directions;
};

// The grip as the first recording that has it holds it.
const Grip& FirstOf(const GripMotions::Grip& grip, const CalibrationProblem& problem);
// Whether a grip holds these nodes and no others.
bool HoldsExactly(const Grip& grip, const Eigen::VectorXi& nodes);

// The motions of the grips of all fitted recordings.
GripMotions MakeGripMotions(const CalibrationProblem& problem);

// The misfit of a problem with its derivatives with respect to the parameters, to further
// directions and to the directions of the grips. Its Jacobian has these columns in this order.
struct LinearisedWithGrips {
  GripMotions grips;  // with the forces and moments of the simulation
  LinearisedMisfit misfit;
  Eigen::Index parameters = 0, directions = 0;  // numbers of columns

  // Changes of the rows, m per unit of the direction. The misfit must be usable.
  Eigen::MatrixXd OfDirections() const {
    return misfit.jacobian.middleCols(parameters, directions);
  }
  // Changes of the rows by the directions of the grips.
  Eigen::MatrixXd OfGrips() const {
    return misfit.jacobian.rightCols(misfit.jacobian.cols() - parameters - directions);
  }
};
// One tangent-linear simulation along the motion at these values of the problem's parameters. A
// motion that cannot be predicted gives a misfit that is not usable. `on_frame` is
// LineariseOptions::on_frame. Throws Interrupted.
LinearisedWithGrips LineariseWithGrips(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& values,
                                       std::vector<MisfitDirection> directions,
                                       const std::function<void()>& on_frame = {});

// How grip `grip` of the model was recorded; null for one that does not move.
const RecordedGrip* RecordedAs(const Recording& recording, size_t grip);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_GRIP_MOTIONS_H_
