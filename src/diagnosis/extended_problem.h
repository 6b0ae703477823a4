// A fitted model with one more effect, as a fit of its own.
#ifndef LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_
#define LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/progress.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/refit_store.h"

namespace lacuna {

// The model that effects are tried on.
struct PresentModel {
  const CalibrationProblem& problem;
  const Eigen::VectorXd& values;   // of its parameters
  const LinearisedMisfit& misfit;  // there
  Progress* progress;
  RefitStore* kept = nullptr;  // where fits are kept, and found again
};

struct NamedEstimate {
  std::string name, unit;  // SI
  ParameterEstimate estimate;
};

// Its parameters are the present model's, the effect's, those of recordings; then the amounts of
// the nuisances that were adopted, which change the misfit as they did at the present model.
class ExtendedProblem {
 public:
  // Null `effect`: the model as it is. What is given must outlive it.
  ExtendedProblem(const PresentModel& present, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted);

  // The problem that has the effect, without the amounts of nuisances.
  const CalibrationProblem& problem() const { return with_; }
  // The parameters of the effect that the problem has more, in the order of its card, at these
  // values of the problem's parameters.
  Eigen::VectorXd OwnParameters(const Eigen::VectorXd& values) const;
  Eigen::Index OwnCount() const { return own_; }  // of the parameters, without the amounts
  // Of a calibration's estimates, those of what makes the effect's size, and its others.
  std::vector<ParameterEstimate> SizesIn(const Calibration& calibration) const;
  std::vector<NamedEstimate> OthersIn(const Calibration& calibration) const;

  // Where a fit is to begin: where first order expects the best parameters, or part of the way
  // there, or at the present ones.
  Eigen::VectorXd Start() const;
  // With the effect held at a size, everything else where it is best: what a size asks of the other
  // parameters is no straight line. Empty: nothing could be fitted. Throws Interrupted.
  Eigen::VectorXd StartAtItsSize(const std::string& stage) const;

  // Throws Interrupted.
  Calibration CalibrateFrom(const Eigen::VectorXd& start, const std::string& stage,
                            bool holds_effect = false) const;
  // The model with the effect fitted from its study's own start, nuisances apart.
  Calibration CalibrateAfresh() const;

 private:
  std::vector<CalibratedParameter> ParametersFrom(const Eigen::VectorXd& start,
                                                  bool holds_effect) const;
  // A fit that begins so, or what was kept of it. `what`: which of those that begin so.
  Calibration Kept(const std::string& what, const std::vector<CalibratedParameter>& parameters,
                   const std::function<Calibration()>& fit) const;
  std::string KeyOf(const std::vector<CalibratedParameter>& parameters,
                    const std::string& what) const;
  Prediction Predict(const Eigen::VectorXd& at, bool with_jacobian,
                     CalibrationProblem::FitMemory* memory = nullptr) const;
  double Missed(const Eigen::VectorXd& at) const;
  // From the present parameters towards others, and the effect from nothing towards the size that
  // it begins with.
  Eigen::VectorXd PartWay(double part, const Eigen::VectorXd& towards) const;

  const PresentModel& present_;
  const ScoredVariant* effect_;
  PredictionStudy study_;
  CalibrationProblem with_;
  // How many of the parameters are the model's, then the effect's, and, with those of recordings,
  // all of with_'s.
  Eigen::Index shared_, added_, own_;
  Eigen::VectorXd left_;      // whitened misfit of the present model, fitted frames
  Eigen::MatrixXd nuisance_;  // and how what was adopted changes it, per unit
  std::vector<CalibratedParameter> parameters_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENDED_PROBLEM_H_
