#define LACUNA_LANES 8
#include "registration/gaussian_sums_kernel.h"

namespace lacuna {

extern const GaussianKernels kAvx2Kernels;
const GaussianKernels kAvx2Kernels = {InstructionSet::kAvx2, MassSums, PosteriorSums, MomentSums,
                                      KernelValues,          Expand,   Project};

}  // namespace lacuna
