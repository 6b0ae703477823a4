#include "calibration/calibration_fits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calibration/far_start.h"
#include "core/hash.h"

namespace lacuna {
namespace {

// The short horizon covers this share of the fitted time in which the object moves.
constexpr double kShortHorizon = 0.25;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();
// Where a fit may have ended in a local minimum, it is repeated with the start values of the moduli
// multiplied by each of these factors.
constexpr double kOtherStarts[] = {0.5, 2, 0.25, 4};
// A fit to scans searches for correspondences again after at most this many iterations, because an
// exact fit to wrong correspondences is useless. They have settled when no parameter changes by
// more than `kSettled` times its posterior standard deviation.
constexpr int kIterationsOfRound = 12;
constexpr double kSettled = 0.1;
// As long as the reach is widened, the correspondences are wrong in part: they are renewed after so
// few iterations, and the reach is divided by `kReachStep`.
constexpr int kIterationsWhileFar = 4;
constexpr double kReachStep = 2;
// While only the recordings' own parameters are fitted, the model's stay within this share of what
// matters to the user. The forces of hands, nearly linear, take two or three iterations.
constexpr double kHeldDeviation = 1e-3;
constexpr int kIterationsOfHeld = 6;

// The largest change of a parameter, in units of its posterior standard deviation.
double LargestChange(const std::vector<CalibratedParameter>& parameters,
                     const Calibration& calibration, const Eigen::VectorXd& from) {
  double largest = 0;
  for (size_t k = 0; k < parameters.size(); ++k)
    largest = std::max(
        largest, std::abs(DeviationsTo(from[static_cast<Eigen::Index>(k)], calibration.estimates[k],
                                       parameters[k].log_scale)));
  return largest;
}

// The time, s after the recording's start, of the last fitted frame before the markers move. 0 for
// scans, whose points differ from frame to frame.
double BeginningOfMotion(const RecordingModel& model, const std::vector<int>& frames) {
  constexpr double kHardly = 0.03;  // fraction of the largest displacement that counts as rest
  if (model.recording().ShowsScans()) return 0;
  const Recording& recording = model.measured();
  const Eigen::Matrix3Xd& first = recording.markers.positions[frames.front()];
  std::vector<double> moved;  // for each frame: m, largest displacement of a marker
  for (const int frame : frames) {
    double most = 0;
    for (const double distance : (recording.markers.positions[frame] - first).colwise().norm())
      if (distance > most) most = distance;  // false for NaN, a marker that was not observed
    moved.push_back(most);
  }
  const double least = kHardly * *std::max_element(moved.begin(), moved.end());
  const auto moving =
      std::find_if(moved.begin(), moved.end(), [&](double distance) { return distance > least; });
  if (moving == moved.begin() || moving == moved.end()) return 0;
  const int last = frames[static_cast<size_t>(moving - moved.begin()) - 1];
  return std::max(0.0, model.FrameTime(last) - model.recording().StartTime());
}

// Stages of one fit, whose predictions are counted together.
class Fitter {
 public:
  Fitter(const CalibrationProblem& problem, Progress* progress, FitBudget* budget, FitStore* kept)
      : problem_(problem),
        progress_(*progress),
        own_budget_(problem.study().time_step),
        budget_(budget != nullptr ? *budget : own_budget_),
        kept_(kept) {}

  bool IsOutOfBudget() const { return budget_.IsUsedUp(TimeStep()); }

  // The rms of the whitened residual over all fitted frames; infinite where the prediction is not
  // usable. It takes one prediction of the budget.
  double RmsAt(const Eigen::VectorXd& values) {
    budget_.Spend(1, TimeStep());
    const ResidualEvaluation prediction = problem_.Predict(values, /*with_jacobian=*/false);
    return prediction.usable ? RootMeanSquare(prediction) : kUnlimited;
  }

  Calibration Stage(const std::string& name, double horizon, const Eigen::VectorXd& start) {
    progress_.Begin(name, 0);
    Calibration calibration =
        problem_.HasScans() ? FitScans(horizon, {start, 1, 0, ""}) : FitOnce(horizon, start, {});
    return Finished(std::move(calibration));
  }

  Calibration Beginning(const std::string& name, const Eigen::VectorXd& start) {
    if (!problem_.HasScans()) return Stage(name, ShortHorizon(problem_), start);
    progress_.Begin(name, 0);
    const FarStart far = FindFarStart(problem_, start);
    budget_.Spend(far.predictions, TimeStep());
    evaluations_ += far.predictions;
    searched_ = far.summary;
    return Finished(FitScans(ShortHorizon(problem_), far));
  }

  // The start of an experiment that `lacuna add` has written is where a diagnosis has judged the
  // model, except for what the recordings do not share, such as the force of a hand. With that
  // fitted, the start usually comes close over all frames, and the short horizon would only lead it
  // astray in what it does not determine. Not usable where it does not come close.
  Calibration FromJudgedValues(const Eigen::VectorXd& start) {
    Calibration judged;
    if (problem_.study().explained_misfit == 0 || problem_.HasScans()) return judged;
    progress_.Begin("fit from the diagnosis", 0);
    judged.parameters = start;
    judged.rms = RmsAt(start);
    ++evaluations_;
    if (judged.rms > kLocalMinimumSuspected)
      judged = FitOnce(kUnlimited, start, {.max_iterations = kIterationsOfHeld}, Fits::kRecordings);
    judged.usable = judged.parameters.size() > 0 && judged.rms <= kLocalMinimumSuspected;
    judged.message.clear();
    return Finished(std::move(judged));
  }

  // The beginning of a fit from the study's own start.
  Calibration FirstPart(const Eigen::VectorXd& start) {
    const Calibration judged = FromJudgedValues(start);
    return judged.usable ? judged : Beginning("fit, first part", start);
  }

  Calibration Whole(const Eigen::VectorXd& start, const Calibration& beginning) {
    const Eigen::VectorXd& near = beginning.parameters.size() > 0 ? beginning.parameters : start;
    Calibration calibration = Stage("fit", kUnlimited, near);
    // The initial error is that at the caller's start values, not at the end of the first part.
    calibration.start_rms = RmsAt(start);
    return calibration;
  }

  void CountAlso(int evaluations) { evaluations_ += evaluations; }
  int evaluations() const { return evaluations_; }

 private:
  Calibration Finished(Calibration calibration) {
    progress_.Report(evaluations_, calibration.rms);  // replaces that of the last values tried
    if (!calibration.usable && !searched_.empty()) calibration.message += "; " + searched_;
    progress_.End(calibration.message);
    calibration.predictions = evaluations_;
    return calibration;
  }

  enum class Fits { kAll, kRecordings };  // kRecordings: the model's parameters stay near the start
  Calibration FitOnce(double horizon, const Eigen::VectorXd& start,
                      const CalibrationOptions& options, Fits fits = Fits::kAll) {
    std::vector<CalibratedParameter> parameters = problem_.parameters();
    for (size_t k = 0; k < parameters.size(); ++k) {
      parameters[k].start =
          std::clamp(start[static_cast<Eigen::Index>(k)], parameters[k].min, parameters[k].max);
      if (fits == Fits::kAll || k >= problem_.study().fitted.size()) continue;
      parameters[k].prior_mean = parameters[k].start;
      parameters[k].prior_deviation = kHeldDeviation * parameters[k].typical;
    }
    CalibrationOptions within = options;
    within.max_predictions = budget_.PredictionsLeft(TimeStep());
    const int before = evaluations_;
    const auto fit = [&] { return NewFit(horizon, parameters, within); };
    const Calibration calibration =
        kept_ != nullptr ? kept_->FindOrFit(KeyOf(horizon, parameters, within), fit) : fit();
    evaluations_ = before + calibration.predictions;
    budget_.Spend(calibration.predictions, TimeStep());
    return calibration;
  }

  // Depends on its arguments, the problem and the reach alone, so that a kept fit can replace it.
  Calibration NewFit(double horizon, const std::vector<CalibratedParameter>& parameters,
                     const CalibrationOptions& options) {
    memory_.correspondences.clear();
    memory_.equilibria.clear();
    return Calibrate(
        parameters,
        [&](const Eigen::VectorXd& at, bool with_jacobian) {
          ResidualEvaluation prediction = problem_.Predict(at, with_jacobian, horizon, &memory_);
          progress_.Report(++evaluations_,
                           prediction.usable ? RootMeanSquare(prediction) : std::nan(""));
          return prediction;
        },
        options);
  }

  std::string KeyOf(double horizon, const std::vector<CalibratedParameter>& parameters,
                    const CalibrationOptions& options) const {
    std::string all = fmt::format("{:a} {:a} {:a} {:a} {:a} {} {}", horizon, TimeStep(),
                                  problem_.noise(), problem_.scan_noise(), memory_.reach_factor,
                                  options.max_iterations, options.max_predictions);
    for (const CalibratedParameter& parameter : parameters)
      all += fmt::format(" {:a} {:a}", parameter.start, parameter.prior_deviation);
    return HashBytes(all);
  }

  double TimeStep() const { return problem_.study().time_step; }

  // Brings the prediction near while the reach decreases to scan.reach. A round that fails leaves
  // the values as they are.
  Eigen::VectorXd Approach(double horizon, const FarStart& far) {
    Eigen::VectorXd values = far.values;
    for (double factor = far.reach_factor; factor > 1; factor /= kReachStep) {
      memory_.reach_factor = factor;
      const Calibration round = FitOnce(horizon, values, {.max_iterations = kIterationsWhileFar});
      if (round.HasSolution()) values = round.parameters;
      if (IsOutOfBudget()) break;
    }
    memory_.reach_factor = 1;
    return values;
  }

  Calibration FitScans(double horizon, const FarStart& start) {
    Calibration calibration;
    Eigen::VectorXd values = Approach(horizon, start);
    const int most = CalibrationOptions{}.max_iterations;
    for (int iterations = 0; iterations < most;) {
      calibration = FitOnce(horizon, values,
                            {.max_iterations = std::min(kIterationsOfRound, most - iterations)});
      if (!calibration.HasSolution() || (calibration.is_out_of_budget && IsOutOfBudget()))
        return calibration;
      const double moved = LargestChange(problem_.parameters(), calibration, values);
      values = calibration.parameters;
      if (moved < kSettled) {
        // So small a change is accepted even if the round itself has not converged.
        calibration.usable = true;
        calibration.message.clear();
        return calibration;
      }
      iterations += std::max(calibration.iterations, 1);
    }
    calibration.usable = false;
    calibration.is_out_of_budget = false;
    calibration.message =
        "the correspondences between scanned points and the surface did not settle: start nearer "
        "to the solution, fit fewer parameters at once, or give scan.reach a smaller value";
    return calibration;
  }

  const CalibrationProblem& problem_;
  Progress& progress_;
  FitBudget own_budget_;
  FitBudget& budget_;
  FitStore* kept_;
  CalibrationProblem::FitMemory memory_;
  int evaluations_ = 0;
  std::string searched_;  // FarStart::summary
};

}  // namespace

double ShortHorizon(const CalibrationProblem& problem) {
  double longest = 0;
  for (const RecordingModel& model : problem.models()) {
    const std::vector<int> frames = model.recording().FittedFrames();
    if (frames.empty()) continue;
    const double rest = BeginningOfMotion(model, frames);
    const double whole = model.FrameTime(frames.back()) - model.recording().StartTime();
    longest = std::max(longest, rest + kShortHorizon * (whole - rest));
  }
  return longest;
}

Calibration FitShortHorizon(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                            Progress* progress, FitBudget* budget, FitStore* kept) {
  return Fitter(problem, progress, budget, kept).FirstPart(start);
}

Calibration FitInStages(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                        Progress* progress) {
  Fitter fitter(problem, progress, nullptr, nullptr);
  return fitter.Whole(start, fitter.Beginning("fit, first part", start));
}

Calibration RefineFit(const CalibrationProblem& problem, const Eigen::VectorXd& near,
                      Progress* progress, FitBudget* budget, FitStore* kept) {
  return Fitter(problem, progress, budget, kept).Stage("fit", kUnlimited, near);
}

Calibration FitFromStart(const CalibrationProblem& problem, Progress* progress,
                         const Calibration* beginning, FitBudget* budget, FitStore* kept) {
  Fitter fitter(problem, progress, budget, kept);
  if (beginning != nullptr) fitter.CountAlso(beginning->predictions);
  const Eigen::VectorXd start = problem.Start();
  Calibration calibration =
      fitter.Whole(start, beginning != nullptr ? *beginning : fitter.FirstPart(start));
  const auto keep_better = [&](Calibration other) {
    if (other.usable && (!calibration.usable || other.rms < calibration.rms)) {
      other.start_rms = calibration.start_rms;
      calibration = std::move(other);
    }
    calibration.predictions = fitter.evaluations();
  };
  // Where the body hardly deforms over the short horizon, that can lead far away from a good start.
  if (calibration.start_rms < calibration.rms && !fitter.IsOutOfBudget())
    keep_better(fitter.Stage("fit from the start values", kUnlimited, start));
  if (calibration.usable && calibration.rms <= kLocalMinimumSuspected) return calibration;
  // Equilibria have no period, so that other moduli lead to the same minimum. FindFarStart has
  // tried others for scans.
  if (problem.study().scheme == TimeScheme::kQuasiStatic &&
      (calibration.usable || problem.HasScans()))
    return calibration;

  double least = calibration.usable ? calibration.rms : kUnlimited;
  Calibration nearest;
  for (const double factor : kOtherStarts) {
    Eigen::VectorXd other = start;
    for (size_t k = 0; k < problem.parameters().size(); ++k)
      if (problem.IsModulus(k)) other[static_cast<Eigen::Index>(k)] *= factor;
    if (other == start || fitter.IsOutOfBudget()) break;
    Calibration first = fitter.Beginning(
        fmt::format("fit, moduli from {:g} times their start values", factor), other);
    const double rms = first.HasSolution() ? fitter.RmsAt(first.parameters) : kUnlimited;
    if (rms >= least) continue;
    least = rms;
    nearest = std::move(first);
  }
  if (nearest.parameters.size() > 0 && !fitter.IsOutOfBudget())
    keep_better(fitter.Whole(nearest.parameters, nearest));
  calibration.predictions = fitter.evaluations();
  return calibration;
}

}  // namespace lacuna
