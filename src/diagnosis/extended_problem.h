// A fitted model with one more effect, as a fit of its own.
#ifndef LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_
#define LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/fit_store.h"
#include "calibration/linear_misfit.h"
#include "core/progress.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/marginal_nuisances.h"

namespace lacuna {

// The fitted model without any additional effect, with which effects are compared. References must
// outlive it.
struct BaselineModel {
  const CalibrationProblem& problem;
  const Eigen::VectorXd& values;   // the fitted values of problem.parameters()
  const LinearisedMisfit& misfit;  // at `values`
  Progress* progress;
  FitStore* kept = nullptr;  // finished fits are read from here and added to it; null: not kept
  NoiseLevel noise = {};     // with which refits are compared
  double model_error = 0;    // EffectRanking::ModelError()
};
// The one that was ranked: with the misfit, the noise and the model error of `ranking`.
BaselineModel RankedBaseline(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                             const EffectRanking& ranking, Progress* progress,
                             FitStore* kept = nullptr);

struct NamedEstimate {
  std::string name, unit;  // SI
  ParameterEstimate estimate;
};

// A fit of an extended problem.
struct ExtendedFit {
  Calibration calibration;
  // The misfit at the end of the fit, with its Jacobian, as Linearise() gives it from the
  // baseline's misfit. Not usable if the fit was kept, the recordings are scans, or many frames are
  // held out.
  LinearisedMisfit misfit;
};

// Where a fit starts, and how many predictions were made to find that.
struct FitStart {
  Eigen::VectorXd values;
  int predictions = 0;
};

// The cost at which a fit starts (Calibration::cost), and by how much its first step would reduce
// it to first order.
struct FirstStep {
  double cost = 0, gain = 0;
};

// The baseline model with an effect and the adopted nuisances. The order of its parameters is:
// those of the baseline study, those of the effect, and the nuisance parameters of the recordings.
// The amounts of the adopted nuisances, which change the residual by the same columns as at the
// baseline, are integrated out: the residual of a fit is that of MarginalNuisances.
class ExtendedProblem {
 public:
  // Null `effect`: the baseline with the adopted nuisances. The arguments must outlive the problem.
  ExtendedProblem(const BaselineModel& baseline, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted);

  // The model with the effect, without the adopted nuisances.
  const CalibrationProblem& problem() const { return with_; }
  // The parameters of the effect, in the order of its card, at these values of the problem's
  // parameters.
  Eigen::VectorXd OwnParameters(const Eigen::VectorXd& values) const;
  // The best amounts of the adopted nuisances. `misfit` has the rows of the baseline's.
  Eigen::VectorXd AmountsAt(const LinearisedMisfit& misfit) const;
  // The estimates of the parameters that make the effect's size, and of its other fitted
  // parameters. Their intervals contain the error that the model may have in an unknown direction:
  // an error whose length is u σ, in the direction to which an estimate is most sensitive, moves it
  // by u of the standard deviations that noise alone gives it.
  std::vector<ParameterEstimate> SizesIn(const Calibration& calibration) const;
  // Of the sizes: whether an estimate has ended at an end of its range at which the effect does not
  // vanish, which is the limit of what is plausible.
  std::vector<bool> SizesAtLimit(const Calibration& calibration) const;
  std::vector<NamedEstimate> OthersIn(const Calibration& calibration) const;

  // The start of a fit: the values that first order predicts to be the best, or a part of the way
  // to them, or the baseline's own values, whichever gives the smallest residual first. `refitted`:
  // the baseline's own parameters after a fit without the effect, or empty; the effect added to
  // these is the start where it gives a smaller residual.
  FitStart Start(const Eigen::VectorXd& refitted = {}) const;
  // The best start with the effect held near a given share of its predicted size and the other
  // parameters fitted: their dependence on the size is not linear. These fits together take at most
  // RefitThresholds::most_predictions. No values: none succeeded. Throws Interrupted.
  FitStart StartAtFixedSize(const std::string& stage) const;

  // The first step of CalibrateFrom(at). `misfit`: there, with its Jacobian; columns beyond those
  // of the parameters do not count. Nothing is predicted.
  FirstStep FirstStepFrom(const Eigen::VectorXd& at, const LinearisedMisfit& misfit) const;

  // Fits all parameters. `hopeless_cost`: as in CalibrationOptions. May be called from several
  // threads. Throws Interrupted.
  ExtendedFit CalibrateFrom(const Eigen::VectorXd& start, const std::string& stage,
                            double hopeless_cost, Progress* progress) const;
  // Fits the model with the effect, but without adopted nuisances, from the study's own start. May
  // be called from several threads.
  Calibration CalibrateAfresh(Progress* progress) const;

 private:
  // `holds_effect`: the effect stays near its start, by a narrow prior.
  std::vector<CalibratedParameter> ParametersFrom(const Eigen::VectorXd& start,
                                                  bool holds_effect) const;
  ExtendedFit Fit(const std::vector<CalibratedParameter>& parameters, const std::string& stage,
                  const CalibrationOptions& options, Progress* progress) const;
  // The kept result of this fit, or else that of `fit`, which is then kept. `purpose` distinguishes
  // fits with the same start.
  Calibration Kept(const std::string& purpose, const std::vector<CalibratedParameter>& parameters,
                   double hopeless_cost, const std::function<Calibration()>& fit) const;
  std::string KeyOf(const std::vector<CalibratedParameter>& parameters, const std::string& purpose,
                    double hopeless_cost) const;
  // What one prediction of a fit hands on to the next.
  struct Memory {
    CalibrationProblem::FitMemory of_problem;
    // The latest prediction of all frames with a Jacobian, and its parameters.
    LinearisedMisfit latest = {};
    Eigen::VectorXd of_latest = {};
  };
  ResidualEvaluation Predict(const Eigen::VectorXd& at, bool with_jacobian, Memory* memory) const;
  // The estimate of parameter `k` as SizesIn() and OthersIn() report it.
  ParameterEstimate Reported(const Calibration& calibration, size_t k) const;
  double ResidualNorm(const Eigen::VectorXd& at) const;  // infinite if it cannot be predicted
  // The baseline's values moved by a share of the way to `target`, and the effect by the same share
  // of the way from its null value to its start.
  Eigen::VectorXd PartWay(double share, const Eigen::VectorXd& target) const;
  // The values `own` of the baseline's parameters, and the effect moved by a share of the way from
  // its null value to its start.
  Eigen::VectorXd WithEffectBy(double share, const Eigen::VectorXd& own) const;

  const BaselineModel& baseline_;
  const ScoredVariant* effect_;
  PredictionStudy study_;
  CalibrationProblem with_;
  // Number of the baseline study's parameters and of those of the effect.
  Eigen::Index shared_, added_;
  Eigen::VectorXd residual_;     // whitened, of the baseline in the fitted frames
  MarginalNuisances nuisances_;  // those adopted, in the fitted frames
  bool covers_held_out_;         // derivatives of a search are taken in all frames
  std::vector<CalibratedParameter> parameters_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_
