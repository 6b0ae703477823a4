// Makes OpenBLAS use kernels that match the vector instructions of this processor.
//
// OpenBLAS chooses its kernels when it is loaded, from a list of the processors known at its
// release. A newer processor may be classified as "Prescott" (a Pentium 4 of 2004): results are
// correct, but a dense matrix product is three to five times slower than it could be, without any
// warning. The environment variable OPENBLAS_CORETYPE overrides the choice, but only if it is set
// before the library is loaded; therefore the program restarts itself.
#ifndef LACUNA_CORE_BLAS_KERNELS_H_
#define LACUNA_CORE_BLAS_KERNELS_H_

#include <string>

namespace lacuna {

// Call this first in main, before any thread, file or output. If OpenBLAS has chosen kernels
// without AVX2 on a processor that supports it, the program is restarted with OPENBLAS_CORETYPE set
// and the same arguments, and the call does not return. A value set by the user is respected, which
// also rules out a second restart. If the restart fails, the call prints a warning on standard
// error and the program continues with the slow kernels.
void UseFastBlasKernels(char** argv);

// The name of the kernels in use, e.g. "SkylakeX".
std::string BlasKernelName();

// The instruction sets that matter for the choice of kernels.
struct VectorInstructions {
  bool avx2 = false;    // AVX2 and FMA
  bool avx512 = false;  // AVX-512 F, DQ, BW, VL and CD, and also avx2
};
VectorInstructions InstructionsOfThisProcessor();

// The kernels to request instead of the `chosen` ones; empty if the chosen ones use AVX2 or the
// processor does not support it.
std::string BetterBlasKernels(const std::string& chosen, const VectorInstructions& processor);

// Restarts the program with OPENBLAS_CORETYPE set to `name`. Returns only if that fails.
void RestartWithBlasKernels(const std::string& name, char** argv);

}  // namespace lacuna

#endif  // LACUNA_CORE_BLAS_KERNELS_H_
