// The variants in which an effect is tried: at several places, along several directions, with
// several time scales or other values, as its card says (record/effect_card.h).
#ifndef LACUNA_DIAGNOSIS_CANDIDATE_VARIANTS_H_
#define LACUNA_DIAGNOSIS_CANDIDATE_VARIANTS_H_

#include <map>
#include <string>
#include <vector>

#include "diagnosis/body_extent.h"
#include "diagnosis/candidate_effect.h"
#include "experiment/model_reader.h"
#include "fem/body.h"
#include "fem/model.h"
#include "record/effect_card.h"

namespace lacuna {

// The model and the recordings for which candidates are made.
struct CandidateSetting {
  const Body& body;
  // The effects of the model, the material first. Candidates take moduli from the material and the
  // acceleration from gravity; effects that the model contains are not tried again.
  const EffectList& effects;
  BodyScale scale;                        // of the body
  double time_step = 0;                   // s, of the simulation: the shortest relaxation time
  double duration = 0;                    // s, of the recordings: the longest relaxation time
  std::vector<std::string> without = {};  // types that are excluded
  std::vector<OwnLaw> laws = {};          // laws of the user, tried like those of the catalogue
  std::vector<char> gripped = {};         // one flag per node (fem/model.h); empty: none is gripped
};

struct CandidateVariant {
  std::string name;                      // as CandidateEffect::variant
  std::map<std::string, double> values;  // SI, by parameter: those that the variant determines
  VariantPosition position = {};
  std::map<std::string, CandidateEffect::Range> known = {};  // as CandidateEffect::known
};

// The variants that `tried_at` of the card asks for; none for contact planes, which
// pilot_hypotheses.h tries. Their values may have names that are no parameters of the card. CHECKs
// that the card has the parameter of which it lists values. `extent`: of the body of `setting`.
std::vector<CandidateVariant> VariantsFor(const EffectCard& card, const BodyExtent& extent,
                                          const CandidateSetting& setting);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_CANDIDATE_VARIANTS_H_
