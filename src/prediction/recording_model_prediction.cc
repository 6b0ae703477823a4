// The prediction of a recording by its model.
#include "prediction/compared_frame.h"
#include "prediction/reading_times.h"
#include "prediction/recording_model.h"

namespace lacuna {
namespace {

// Gives the misfit of a reading the rows of exactly `frames` frames. Where a prediction stops
// early, a load cell with a delay may have reached more or fewer of them; the latter count as not
// read.
void Truncate(size_t frames, const MeasuredReaction& reading, ReactionMisfit* misfit) {
  misfit->components = reading.Components();
  const Eigen::Index before = misfit->residual.size();
  const Eigen::Index rows = misfit->components * static_cast<Eigen::Index>(frames);
  misfit->residual.conservativeResize(rows);
  misfit->jacobian.conservativeResize(rows, misfit->jacobian.cols());
  misfit->count.resize(static_cast<size_t>(rows), 0);
  if (rows <= before) return;
  misfit->residual.tail(rows - before).setZero();
  misfit->jacobian.bottomRows(rows - before).setZero();
}

// The times, s, on the model's clock, at which frames that are stamped `frame_times` are seen and
// the load cells are read.
std::vector<ReadingTime> VisitedTimes(const RecordingModel& model,
                                      const std::vector<double>& frame_times,
                                      const Eigen::VectorXd& nuisance) {
  const std::vector<double> of_model = Delayed(frame_times, model.Delay(nuisance));
  std::vector<std::vector<double>> of_cells(model.Reactions().size());
  for (size_t k = 0; k < of_cells.size(); ++k)
    if (model.Reactions()[k].delay_deviation > 0)
      of_cells[k] = Delayed(of_model, model.CellDelay(k, nuisance));
  return ReadingTimesOf(of_model, of_cells);
}

// Removes the space of the frames that the prediction has not reached, and completes the reactions.
// `times` (s) are those of all frames that were asked for.
void FinishMisfit(const RecordingModel& model, std::vector<double> times, Misfit* misfit) {
  const Eigen::Index reached = model.observer().Components() * misfit->points *
                               static_cast<Eigen::Index>(misfit->frames.size());
  misfit->residual.conservativeResize(reached);
  misfit->jacobian.conservativeResize(reached, Eigen::NoChange);
  times.resize(misfit->frames.size());
  for (size_t k = 0; k < misfit->reactions.size(); ++k) {
    Truncate(misfit->frames.size(), model.Reactions()[k], &misfit->reactions[k]);
    ChooseSign(model.Reactions()[k], times, &misfit->reactions[k]);
  }
}

}  // namespace

Misfit RecordingModel::Predict(const std::vector<int>& frames, const Eigen::VectorXd& nuisance,
                               const std::vector<MisfitDirection>& directions,
                               const PredictionHints& hints,
                               const std::function<void()>& on_frame) const {
  const Model placed = PlacedModel(nuisance);
  PredictionOptions options = Options(nuisance);
  options.reactions = MeasuredReactions(Reactions(), placed);
  if (hints.near_equilibrium != nullptr) options.held_guess = *hints.near_equilibrium;
  std::vector<double> times;  // s, on the recording's clock
  for (const int frame : frames) times.push_back(recording_.recording.times[frame]);
  const std::vector<ReadingTime> visits = VisitedTimes(*this, times, nuisance);
  std::vector<Perturbation> perturbations;
  for (const MisfitDirection& direction : directions)
    if (direction.IsSimulated()) perturbations.push_back(PerturbationOf(direction, nuisance, placed));
  const Eigen::Isometry3d registration = Registration(nuisance);
  const bool is_registered = recording_.shift_deviation > 0 || recording_.turn_deviation > 0;

  Misfit misfit = EmptyMisfit(*this, frames.size(), directions.size());
  misfit.summary = lacuna::Predict(
      placed, options, TimesOf(visits), perturbations,
      [&](int number, const PredictedState& state) {
        const ReadingTime& visit = visits[static_cast<size_t>(number)];
        for (const size_t k : visit.cells)
          AppendReaction(Reactions(), k, times[visit.frame], state, options.start_time, directions,
                         &misfit.reactions[k]);
        if (!visit.shows_frame) return;
        NodalMotion nodal{state.position, state.velocity, {}, state.time > options.start_time};
        if (!perturbations.empty()) nodal.jacobian = state.position_jacobian;
        if (is_registered) nodal.Register(registration);
        const int frame = frames[visit.frame];
        Observed seen = hints.observed != nullptr
                            ? (*hints.observed)[visit.frame]
                            : observer_->ObserveWithin(hints.reach_factor, frame, nodal.position);
        AppendFrame(*this, directions, registration, frame, nodal, std::move(seen), &misfit);
        if (on_frame) on_frame();
      });
  FinishMisfit(*this, std::move(times), &misfit);
  return misfit;
}

}  // namespace lacuna
