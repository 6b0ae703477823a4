// The effects that a model may lack, each at its null value and in the variants that cannot be
// found by a derivative: places, directions, times.
#ifndef LACUNA_DIAGNOSIS_CANDIDATES_H_
#define LACUNA_DIAGNOSIS_CANDIDATES_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "experiment/model_reader.h"
#include "fem/body.h"
#include "fem/model.h"

namespace lacuna {

// Where a variant stands among the others of its effect; by nothing: it has no neighbours.
struct VariantPosition {
  // Variants of the same line, 1 or more, follow one another in place or time.
  int line = 0, number = 0;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();   // either way along it
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m
  double spacing = 0;                               // m: how far away neighbours in place may be

  bool IsSingle() const { return line == 0 && spacing == 0 && axis.isZero(0); }
};
bool AreNeighbours(const VariantPosition& a, const VariantPosition& b);

struct CandidateEffect {
  std::string type;     // of the effect
  std::string variant;  // "τ = 0.3 s", "at the tip"; empty where there is one only
  std::shared_ptr<const Effect> effect;  // at its null value; a pilot's at its pilot setting
  // The parameters that make its size: one, or the three components of a vector. Empty: a pilot,
  // which has no derivative at its null value (pilot_hypotheses.h); its one amount is the share of
  // what the pilot setting changes, 1 there.
  std::vector<int> amplitude;
  // Of a pilot that acts besides: the parameters that a refit moves, each with its prior deviation
  // from the pilot setting, SI.
  std::map<std::string, double> refined = {};
  VariantPosition position = {};
  // What is known of the others that a refit moves, of some of them, SI: a place lies on the body.
  struct Range {
    double min = 0, max = 0;
  };
  std::map<std::string, Range> known = {};
  // It takes the place of the model's elasticity law; false: it acts besides.
  bool replaces_material = false;

  bool IsPilot() const { return amplitude.empty(); }
};

// The largest plausible size of a parameter: the scale of its prior.
double PlausibleScale(const ParameterCard& card);

// One of the numbers that make a candidate's size.
struct CandidateAmount {
  std::string name, unit;
  double plausible = 1;      // the largest size, the scale of its prior
  bool is_positive = false;  // it cannot be negative
};
std::vector<CandidateAmount> AmountsOf(const CandidateEffect& candidate);

// What the variants are chosen for.
struct CandidateSetting {
  const Body& body;
  // The model's effects, the material first: what effects take from the material, gravity, and
  // which effects it has already.
  const EffectList& effects;
  double time_step = 0;  // s: of the simulation,
  double duration = 0;   // s: and of the recording; relaxation times lie between them
  std::vector<std::string> without = {};  // types that are not wanted
  std::vector<OwnLaw> laws = {};          // the user's, tried like the catalogue's
};

// All effects of the catalogue whose size has a null value and that the model does not have yet,
// and the user's laws. Contact, which has no derivative at its null value (pilot_hypotheses.h), is
// not among them.
std::vector<CandidateEffect> MakeCandidates(const CandidateSetting& setting);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_CANDIDATES_H_
