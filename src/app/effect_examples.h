// The files of configs/effects, as they were when the program was built.
#ifndef LACUNA_APP_EFFECT_EXAMPLES_H_
#define LACUNA_APP_EFFECT_EXAMPLES_H_

#include <vector>

namespace lacuna {

struct EffectExample {
  const char* file;  // "gravity.yaml"
  const char* text;
};

const std::vector<EffectExample>& EffectExamples();

}  // namespace lacuna

#endif  // LACUNA_APP_EFFECT_EXAMPLES_H_
