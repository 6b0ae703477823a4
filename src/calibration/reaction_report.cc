#include "calibration/reaction_report.h"

#include <iterator>
#include <limits>

#include "geometry/rigid_fit.h"

namespace lacuna {
namespace {

// The mean displacement of the nodes of a grip, m, at a time of the model.
Eigen::Vector3d GripDisplacement(const Model& model, size_t grip, double time) {
  const Grip& held = model.grips[grip];
  if (!held.motion || held.nodes.size() == 0) return Eigen::Vector3d::Zero();
  const Eigen::Matrix3Xd rest = model.body->mesh.nodes(Eigen::all, held.nodes);
  return (held.motion(time) - rest).rowwise().mean();
}

// The rotation vector of the rigid motion nearest to that of the nodes of a grip, rad.
Eigen::Vector3d GripRotation(const Model& model, size_t grip, double time) {
  const Grip& held = model.grips[grip];
  if (!held.motion || held.nodes.size() < 3) return Eigen::Vector3d::Zero();
  const Eigen::Matrix3Xd rest = model.body->mesh.nodes(Eigen::all, held.nodes);
  const Eigen::AngleAxisd turn(FitRigidMotion(rest, held.motion(time)).motion.linear());
  return turn.angle() * turn.axis();
}

// `motion` of a grip relative to its mean over the other grips, if there are any: a load cell on a
// fixed grip then shows the motion of the one that is driven.
template <typename Motion>
Eigen::Vector3d RelativeMotion(const Model& model, size_t grip, double time, const Motion& motion) {
  Eigen::Vector3d others = Eigen::Vector3d::Zero();
  for (size_t other = 0; other < model.grips.size(); ++other)
    if (other != grip)
      others += motion(model, other, time) / static_cast<double>(model.grips.size() - 1);
  return motion(model, grip, time) - others;
}

}  // namespace

CsvTable ReactionTable(const CalibrationProblem& problem,
                       const std::vector<RecordingMisfit>& misfits, bool torques) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const char* names[] = {"recording",
                         "reaction",
                         "component",
                         "frame",
                         "time_s",
                         "fitted",
                         torques ? "rotation_rad" : "displacement_m",
                         torques ? "measured_N_m" : "measured_N",
                         torques ? "difference_N_m" : "difference_N"};
  std::vector<std::vector<double>> columns(std::size(names));
  for (size_t r = 0; r < misfits.size(); ++r) {
    const RecordingModel& model = problem.models()[r];
    const Misfit& misfit = misfits[r].misfit;
    const double delay = model.Delay(misfits[r].nuisance);
    for (size_t k = 0; k < misfit.reactions.size(); ++k) {
      const MeasuredReaction& reading = model.Reactions()[k];
      if (reading.is_torque != torques) continue;
      const double late = delay + model.CellDelay(k, misfits[r].nuisance);
      for (size_t f = 0; f < misfit.frames.size(); ++f) {
        const double time = model.FrameTime(misfit.frames[f]);
        const Eigen::VectorXd moved = reading.directions.transpose() *
                                      RelativeMotion(model.model(), reading.held, time - late,
                                                     torques ? GripRotation : GripDisplacement);
        for (int c = 0; c < reading.Components(); ++c) {
          const size_t row = f * static_cast<size_t>(reading.Components()) + static_cast<size_t>(c);
          const bool seen = misfit.reactions[k].count[row] > 0;
          const double row_of_table[] = {
              static_cast<double>(r),
              static_cast<double>(k),
              static_cast<double>(c),
              static_cast<double>(misfit.frames[f]),
              time,
              static_cast<double>(misfits[r].fitted[f]),
              moved[c],
              seen ? misfit.reactions[k].sign * ReadingAt(reading, time)[c] : kNone,
              seen ? misfit.reactions[k].residual[static_cast<Eigen::Index>(row)] -
                         misfits[r].reactions[k].tare[static_cast<size_t>(c)]
                   : kNone};
          for (size_t n = 0; n < columns.size(); ++n) columns[n].push_back(row_of_table[n]);
        }
      }
    }
  }
  CsvTable table;
  for (size_t n = 0; n < columns.size() && !columns[n].empty(); ++n)
    table.push_back(
        {names[n], Eigen::Map<Eigen::VectorXd>(columns[n].data(),
                                               static_cast<Eigen::Index>(columns[n].size()))});
  return table;
}

}  // namespace lacuna
