#include "prediction/setting_derivative.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fem/cloneable_effect.h"

namespace lacuna {
namespace {

// An effect that exerts no force itself, so that it may stand beside the model as a perturbation
// does; the derivative by its parameter is that of another effect by a setting.
class SettingDifference final : public CloneableEffect<SettingDifference> {
 public:
  SettingDifference(std::shared_ptr<const Effect> effect, int setting) : setting_(setting) {
    SetEffect(std::move(effect));
  }

  const EffectCard& Card() const override { return effect_->Card(); }
  Eigen::VectorXd Parameters() const override { return effect_->Parameters(); }
  void SetParameters(const Eigen::VectorXd& values) { SetEffect(effect_->WithParameters(values)); }

  void AddForce(const Kinematics&, Eigen::VectorXd*) const override {}
  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    CHECK_EQ(parameter, setting_);
    const Eigen::Index half = at.state.size() / 2;
    const Eigen::VectorXd of_more = at.state.head(half), of_less = at.state.tail(half);
    Eigen::VectorXd more = Eigen::VectorXd::Zero(derivative->size()), less = more;
    more_->AddForce(at.WithState(of_more), &more);
    less_->AddForce(at.WithState(of_less), &less);
    *derivative += (more - less) / (2 * step_);
  }

  // The internal variables with p + h, then those with p − h.
  Eigen::Index StateSize(const Body& body) const override { return 2 * effect_->StateSize(body); }
  void InitialState(const Body& body, Eigen::VectorXd* state) const override {
    Eigen::VectorXd of_one(effect_->StateSize(body));
    effect_->InitialState(body, &of_one);
    *state = of_one.replicate(2, 1);
  }
  void AdvanceState(const Kinematics& at, Eigen::VectorXd* state_at_end) const override {
    const Eigen::Index half = at.state.size() / 2;
    if (half == 0) return;
    const Eigen::VectorXd of_more = at.state.head(half), of_less = at.state.tail(half);
    Eigen::VectorXd more(half), less(half);
    more_->AdvanceState(at.WithState(of_more), &more);
    less_->AdvanceState(at.WithState(of_less), &less);
    *state_at_end << more, less;
  }

 private:
  void SetEffect(std::shared_ptr<const Effect> effect) {
    // The step is this share of the plausible size, or of the distance to a bound, at which the
    // force may be singular: the truncation error is 1e-8 of the derivative then, and the rounding
    // error 1e-12 of the force.
    constexpr double kShare = 1e-4;
    effect_ = std::move(effect);
    Eigen::VectorXd values = effect_->Parameters();
    const double value = values[setting_];
    const ParameterCard& card = Card().parameters[static_cast<size_t>(setting_)];
    step_ = kShare * std::min({std::max(std::abs(card.plausible_min), std::abs(card.plausible_max)),
                               value - card.bounds.min, card.bounds.max - value});
    CHECK_GT(step_, 0) << Card().type << "." << card.name << " is at its bound";
    values[setting_] = value + step_;
    more_ = effect_->WithParameters(values);
    values[setting_] = value - step_;
    less_ = effect_->WithParameters(values);
  }

  int setting_;
  double step_ = 0;  // h
  std::shared_ptr<const Effect> effect_, more_, less_;
};

}  // namespace

Perturbation ParameterPerturbation(const std::shared_ptr<const Effect>& effect, int parameter) {
  if (!effect->Card().parameters[static_cast<size_t>(parameter)].setting)
    return {.effect = effect, .parameter = parameter};
  return {.effect = std::make_shared<const SettingDifference>(effect, parameter),
          .parameter = parameter};
}

}  // namespace lacuna
