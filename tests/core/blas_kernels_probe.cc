// Prints the BLAS kernels and the arguments it runs with; started by blas_kernels_test.
#include <cstdlib>
#include <iostream>
#include <string>

#include "core/blas_kernels.h"

int main(int argc, char** argv) {
  // OpenBLAS cannot be made to misjudge the processor, so the test requests the restart itself.
  const bool restart = argc > 1 && std::string(argv[1]) == "restart";
  if (restart && std::getenv("OPENBLAS_CORETYPE") == nullptr) {
    lacuna::RestartWithBlasKernels("Nehalem", argv);
  }
  lacuna::UseFastBlasKernels(argv);
  std::cout << lacuna::BlasKernelName();
  for (int k = 1; k < argc; ++k) std::cout << "|" << argv[k];
}
