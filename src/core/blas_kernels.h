// Makes sure that OpenBLAS works with the kernels that this processor deserves.
//
// OpenBLAS chooses its kernels when it is loaded, by a list of processors known when it was
// released. One that is younger may be taken for "Prescott" (a Pentium 4 of 2004): everything is
// right, but a dense product runs three to five times slower than it could, and nothing says so.
// The choice can be overruled by the environment variable OPENBLAS_CORETYPE, but only before the
// library is loaded; hence the program starts itself anew.
#ifndef LACUNA_CORE_BLAS_KERNELS_H_
#define LACUNA_CORE_BLAS_KERNELS_H_

#include <string>

namespace lacuna {

// To be called first in main, before threads, files or output. When OpenBLAS has chosen kernels
// without AVX2 on a processor that has it, the program is started again with OPENBLAS_CORETYPE set
// and the same arguments; the call then does not return. A value that the user has set is
// respected, which also rules out a second restart. Where a restart is impossible, it says so on
// the error stream and goes on with slow kernels.
void UseFastBlasKernels(char** argv);

// The name of the kernels in use, e.g. "SkylakeX".
std::string BlasKernelName();

struct VectorInstructions {
  bool avx2 = false;    // with FMA
  bool avx512 = false;  // F, DQ, BW, VL, CD
};
VectorInstructions InstructionsOfThisProcessor();

// The kernels to ask for in place of the chosen ones; empty when those will do.
std::string BetterBlasKernels(const std::string& chosen, const VectorInstructions& processor);

// Starts the program again with OPENBLAS_CORETYPE set. Returns only when that fails.
void RestartWithBlasKernels(const std::string& name, char** argv);

}  // namespace lacuna

#endif  // LACUNA_CORE_BLAS_KERNELS_H_
