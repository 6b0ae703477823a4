#include "registration/gaussian_sums.h"

#include <glog/logging.h>

namespace lacuna {

extern const GaussianKernels kBaselineKernels;
#if defined(__x86_64__)
extern const GaussianKernels kAvx2Kernels;
extern const GaussianKernels kAvx512Kernels;
#endif

bool IsSupported(InstructionSet set) {
  if (set == InstructionSet::kBaseline) return true;
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  }
  if (set == InstructionSet::kAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
  }
#endif
  return false;
}

const GaussianKernels& KernelsFor(InstructionSet set) {
  CHECK(IsSupported(set));
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kAvx512Kernels;
  if (set == InstructionSet::kAvx2) return kAvx2Kernels;
#endif
  return kBaselineKernels;
}

const GaussianKernels& BestKernels() {
  static const GaussianKernels& best =
      KernelsFor(IsSupported(InstructionSet::kAvx512) ? InstructionSet::kAvx512
                 : IsSupported(InstructionSet::kAvx2) ? InstructionSet::kAvx2
                                                      : InstructionSet::kBaseline);
  return best;
}

}  // namespace lacuna
