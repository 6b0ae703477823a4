#include "diagnosis/extended_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calibration/calibration_fits.h"
#include "calibration/linear_misfit.h"
#include "core/hash.h"
#include "diagnosis/model_change.h"

namespace lacuna {
namespace {

// A rival need not be at its very best to be told from one that fits.
constexpr int kIterations = 25;
constexpr double kTolerance = 1;  // of the cost, whose unit is one standard deviation
// A refit begins this part of the way to what first order expects: the first that predicts better
// than the model without the effect. Moduli that fall below a part of themselves are not believed.
constexpr double kPartsOfTheWay[] = {1, 0.1, 1e-2, 1e-3, 1e-4};
constexpr double kSoundPart = 0.2;
// Or at these parts of the size that first order expects, one after another, with everything but
// the effect fitted to each; the effect is held by a prior of this part of what is typical.
constexpr double kSizesHeld[] = {0.1, 0.3, 1};
constexpr double kHeld = 1e-3;
constexpr int kIterationsHeld = 8;  // such a fit is only where the next begins
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The rows of fitted frames, in the order of CalibrationProblem::Predict.
Eigen::MatrixXd FittedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit) {
  Eigen::MatrixXd kept(rows.rows(), rows.cols());
  Eigen::Index count = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    for (size_t f = 0; f < part.fitted.size(); ++f) {
      if (!part.fitted[f]) continue;
      const Eigen::Index first = part.first_row + static_cast<Eigen::Index>(f) * part.layout.series;
      kept.middleRows(count, part.layout.series) = rows.middleRows(first, part.layout.series);
      count += part.layout.series;
    }
  }
  kept.conservativeResize(count, Eigen::NoChange);
  return kept;
}

// Where a parameter that makes the effect's size has no effect; of other parameters, nothing.
std::optional<double> NullOf(const ScoredVariant& scored, const ModelParameter& parameter) {
  const int index = parameter.places.front().index;
  const std::vector<int>& amplitude = scored.candidate.amplitude;
  if (std::count(amplitude.begin(), amplitude.end(), index) == 0) return std::nullopt;
  return scored.candidate.effect->Card().parameters[index].null_value;
}

PredictionStudy Extended(const PresentModel& present, const ScoredVariant* effect) {
  const PredictionStudy study = present.problem.StudyAt(present.values);
  return effect != nullptr ? WithEffect(study, *effect) : study;
}

void Append(const Eigen::MatrixXd& numbers, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(numbers.data()),
                static_cast<size_t>(numbers.size()) * sizeof(double));
}

}  // namespace

ExtendedProblem::ExtendedProblem(const PresentModel& present, const ScoredVariant* effect,
                                 const AdoptedNuisances& adopted)
    : present_(present),
      effect_(effect),
      study_(Extended(present, effect)),
      with_(study_, present.problem.body()->mesh),
      shared_(static_cast<Eigen::Index>(present.problem.study().fitted.size())),
      added_(static_cast<Eigen::Index>(study_.fitted.size()) - shared_),
      own_(static_cast<Eigen::Index>(with_.parameters().size())),
      left_(FittedRows(WhitenedRows(present.misfit.residual, present.misfit, 0, true),
                       present.misfit)),
      nuisance_(FittedRows(WhitenedRows(adopted.by, present.misfit, 0, true), present.misfit)),
      parameters_(with_.parameters()) {
  for (const LinearPrior& prior : adopted.priors) {
    CalibratedParameter amount;
    amount.name = "nuisance";
    amount.start = amount.prior_mean = prior.mean;
    amount.prior_deviation = amount.typical = prior.deviation;
    amount.is_linear = true;
    parameters_.push_back(amount);
  }
}

Eigen::VectorXd ExtendedProblem::OwnParameters(const Eigen::VectorXd& values) const {
  const EffectList effects = WithValues(study_.effects, study_.fitted, values);
  return (effect_->candidate.replaces_material ? effects.front() : effects.back())->Parameters();
}

std::vector<ParameterEstimate> ExtendedProblem::SizesIn(const Calibration& calibration) const {
  const auto first = calibration.estimates.begin() + shared_;
  return {first, first + static_cast<Eigen::Index>(effect_->candidate.amplitude.size())};
}

std::vector<NamedEstimate> ExtendedProblem::OthersIn(const Calibration& calibration) const {
  std::vector<NamedEstimate> others;
  const size_t first = static_cast<size_t>(shared_) + effect_->candidate.amplitude.size();
  for (size_t k = first; k < static_cast<size_t>(shared_ + added_); ++k)
    others.push_back({parameters_[k].name, with_.UnitOf(k), calibration.estimates[k]});
  return others;
}

Eigen::VectorXd ExtendedProblem::Start() const {
  const Eigen::VectorXd& values = present_.values;
  const Eigen::VectorXd present = PartWay(1, values);
  if (effect_ == nullptr) return present;
  Eigen::VectorXd expected = effect_->fitted;
  for (Eigen::Index k = 0; k < shared_; ++k)
    if (parameters_[k].log_scale && !(expected[k] > kSoundPart * values[k])) expected = values;
  const double without = (left_ + nuisance_ * present.tail(present.size() - own_)).norm();
  Eigen::VectorXd start = present;
  double least = Missed(start);
  for (const double part : kPartsOfTheWay) {
    const Eigen::VectorXd at = PartWay(part, expected);
    if (const double there = Missed(at); there < least) {
      least = there;
      start = at;
    }
    if (least < without || effect_->candidate.IsPilot()) break;
  }
  return start;
}

Eigen::VectorXd ExtendedProblem::StartAtItsSize(const std::string& stage) const {
  Eigen::VectorXd start;
  double least = kInfinity;
  for (const double part : kSizesHeld) {
    const Eigen::VectorXd of_part = PartWay(part, present_.values);
    Eigen::VectorXd at = start.size() > 0 ? start : of_part;
    at.segment(shared_, added_) = of_part.segment(shared_, added_);
    const Calibration fitted = CalibrateFrom(at, stage, /*holds_effect=*/true);
    if (fitted.estimates.empty() || fitted.rms >= least) continue;
    least = fitted.rms;
    start = fitted.parameters;
  }
  return start;
}

std::vector<CalibratedParameter> ExtendedProblem::ParametersFrom(const Eigen::VectorXd& start,
                                                                 bool holds_effect) const {
  std::vector<CalibratedParameter> parameters = parameters_;
  for (size_t k = 0; k < parameters.size(); ++k) {
    CalibratedParameter& parameter = parameters[k];
    parameter.start = start[static_cast<Eigen::Index>(k)];
    const Eigen::Index own = static_cast<Eigen::Index>(k) - shared_;
    if (!holds_effect || own < 0 || own >= added_) continue;
    parameter.prior_mean = parameter.start;
    parameter.prior_deviation = kHeld * parameter.typical;
  }
  return parameters;
}

std::string ExtendedProblem::KeyOf(const std::vector<CalibratedParameter>& parameters,
                                   const std::string& what) const {
  std::string all = what;
  if (effect_ != nullptr) {
    all += effect_->candidate.type + effect_->candidate.variant;
    Append(effect_->candidate.effect->Parameters(), &all);
  }
  for (const CalibratedParameter& parameter : parameters)
    Append(Eigen::Vector3d(parameter.start, parameter.prior_mean, parameter.prior_deviation), &all);
  Append(Eigen::VectorXd::Constant(1, study_.time_step), &all);
  Append(left_, &all);
  Append(nuisance_, &all);
  return HashBytes(all);
}

Calibration ExtendedProblem::Kept(const std::string& what,
                                  const std::vector<CalibratedParameter>& parameters,
                                  const std::function<Calibration()>& fit) const {
  if (present_.kept == nullptr) return fit();
  const std::string key = KeyOf(parameters, what);
  if (const Calibration* kept = present_.kept->Find(key)) return *kept;
  const Calibration calibration = fit();
  present_.kept->Keep(key, calibration);
  return calibration;
}

Calibration ExtendedProblem::CalibrateFrom(const Eigen::VectorXd& start, const std::string& stage,
                                           bool holds_effect) const {
  const std::vector<CalibratedParameter> parameters = ParametersFrom(start, holds_effect);
  CalibrationProblem::FitMemory memory;
  int evaluations = 0;
  const auto predict = [&](const Eigen::VectorXd& at, bool with_jacobian) {
    const Prediction prediction = Predict(at, with_jacobian, &memory);
    present_.progress->Report(
        ++evaluations, prediction.usable ? RootMeanSquare(prediction.residual) : std::nan(""));
    return prediction;
  };
  present_.progress->Begin(stage, 0);
  const Calibration calibration = Kept("fit", parameters, [&] {
    return Calibrate(parameters, predict,
                     {.max_iterations = holds_effect ? kIterationsHeld : kIterations,
                      .cost_tolerance = kTolerance});
  });
  present_.progress->End(calibration.usable ? "" : calibration.message);
  return calibration;
}

Calibration ExtendedProblem::CalibrateAfresh() const {
  return Kept("afresh", with_.parameters(),
              [&] { return FitFrom(with_, with_.Start(), present_.progress); });
}

// Adopted nuisances change the misfit as they did at the model without the effect.
Prediction ExtendedProblem::Predict(const Eigen::VectorXd& at, bool with_jacobian,
                                    CalibrationProblem::FitMemory* memory) const {
  CalibrationProblem::FitMemory of_one;
  CalibrationProblem::FitMemory& known = memory != nullptr ? *memory : of_one;
  known.correspondences.clear();  // sought anew in each prediction
  Prediction prediction = with_.Predict(at.head(own_), with_jacobian, kInfinity, &known);
  if (!prediction.usable) return prediction;
  prediction.residual += nuisance_ * at.tail(at.size() - own_);
  if (with_jacobian) {
    prediction.jacobian.conservativeResize(Eigen::NoChange, at.size());
    prediction.jacobian.rightCols(at.size() - own_) = nuisance_;
  }
  return prediction;
}

double ExtendedProblem::Missed(const Eigen::VectorXd& at) const {
  const Prediction prediction = Predict(at, /*with_jacobian=*/false);
  return prediction.usable ? prediction.residual.norm() : kInfinity;
}

Eigen::VectorXd ExtendedProblem::PartWay(double part, const Eigen::VectorXd& towards) const {
  const Eigen::VectorXd of_problem = present_.values + part * (towards - present_.values);
  Eigen::VectorXd at(static_cast<Eigen::Index>(parameters_.size()));
  for (Eigen::Index k = 0; k < at.size(); ++k) at[k] = parameters_[k].start;
  at.head(shared_) = of_problem.head(shared_);
  at.segment(shared_ + added_, own_ - shared_ - added_) = of_problem.tail(own_ - shared_ - added_);
  for (Eigen::Index k = shared_; k < shared_ + added_; ++k)
    if (const std::optional<double> null = NullOf(*effect_, study_.fitted[k]))
      at[k] = *null + part * (at[k] - *null);
  for (Eigen::Index k = 0; k < at.size(); ++k)
    at[k] = std::clamp(at[k], parameters_[k].min, parameters_[k].max);
  return at;
}

}  // namespace lacuna
