// One effect that a model may lack, in one variant, at its null value.
#ifndef LACUNA_DIAGNOSIS_CANDIDATE_EFFECT_H_
#define LACUNA_DIAGNOSIS_CANDIDATE_EFFECT_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fem/effect.h"
#include "prediction/misfit_direction.h"
#include "record/effect_card.h"

namespace lacuna {

// The position of a variant among the other variants of its effect. A default position has no
// neighbours.
struct VariantPosition {
  // Variants with the same line ≥ 1 form a sequence in place or time, ordered by number.
  int line = 0, number = 0;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   // unit, of either sign; 0: no direction
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m
  double spacing = 0;                               // m: the distance below which places are
                                                    // neighbours; 0: no place

  bool IsSingle() const { return line == 0 && spacing == 0 && axis.isZero(0); }
};

// Whether two variants are next to each other in a sequence, in place or in direction, so that a
// refit of one may move towards the other.
bool AreNeighbours(const VariantPosition& a, const VariantPosition& b);

struct CandidateEffect {
  std::string type;     // the type of the effect
  std::string variant;  // "τ = 0.3 s", "at 5 % of the length"; empty: the only one
  std::shared_ptr<const Effect> effect;  // at its null value; that of a pilot at its pilot setting
  // Indices of the parameters that make the size: one, or the three components of a vector. Empty
  // for a pilot, which has no derivative at its null value (pilot_hypotheses.h); the amount of a
  // pilot is the share of the change that the pilot setting makes, hence 1 at that setting.
  std::vector<int> amplitude;
  // The parameters of an additional pilot that a refit moves, each with the standard deviation of
  // its prior about the pilot setting, SI.
  std::map<std::string, double> refined = {};
  VariantPosition position = {};
  // Bounds, SI, of further parameters that a refit moves: a place lies within the body. A range of
  // one value holds a parameter at the value that the effect has.
  struct Range {
    double min = 0, max = 0;
    bool IsHeld() const { return min == max; }
  };
  std::map<std::string, Range> known = {};
  // The values of the effect's parameters about which the priors of a refit lie, as far as no range
  // and no null value says otherwise. Empty: the values at which the refit starts.
  Eigen::VectorXd prior_centre = {};
  // The effect replaces the elasticity law of the model; false: it is added to the model.
  bool replaces_material = false;
  BodyScale body = kReferenceBody;  // of the model that lacks the effect

  // The card of a parameter, with the range that is plausible in this model.
  ParameterCard CardOf(int parameter) const {
    return PlausibleIn(body, effect->Card().parameters[static_cast<size_t>(parameter)]);
  }

  bool IsPilot() const { return amplitude.empty(); }
};

// The largest plausible distance of a parameter from its null value, or from 0 where it has none,
// SI: the scale of its prior.
double PlausibleScale(const ParameterCard& card);

// One of the numbers that make the size of a candidate.
struct CandidateAmount {
  std::string name, unit;
  double plausible = 1;      // PlausibleScale(): the amount counts from the null value
  bool is_positive = false;  // the amount cannot be negative
};
// One amount for each amplitude, in that order; the share for a pilot.
std::vector<CandidateAmount> AmountsOf(const CandidateEffect& candidate);

// The directions of the amplitudes of these candidates, in their order; pilots have none.
std::vector<MisfitDirection> DirectionsOf(const std::vector<CandidateEffect>& candidates);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_CANDIDATE_EFFECT_H_
