#define LACUNA_LANES 4
#include "registration/gaussian_sums_kernel.h"

namespace lacuna {

extern const GaussianKernels kBaselineKernels;
const GaussianKernels kBaselineKernels = {
    InstructionSet::kBaseline, MassSums, PosteriorSums, MomentSums, KernelValues, Expand, Project};

}  // namespace lacuna
