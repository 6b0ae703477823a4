#define LACUNA_LANES 16
#include "registration/gaussian_sums_kernel.h"

namespace lacuna {

extern const GaussianKernels kAvx512Kernels;
const GaussianKernels kAvx512Kernels = {
    InstructionSet::kAvx512, MassSums, PosteriorSums, MomentSums, KernelValues, Expand, Project};

}  // namespace lacuna
