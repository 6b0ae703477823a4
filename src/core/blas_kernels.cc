#include "core/blas_kernels.h"

#include <cblas.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string_view>

#include "core/interrupt.h"

namespace lacuna {
namespace {

constexpr char kVariable[] = "OPENBLAS_CORETYPE";

// OpenBLAS's names for kernels that use AVX2 or wider instructions.
constexpr std::array<std::string_view, 6> kFastKernels = {
    "Haswell", "Zen", "Excavator", "SkylakeX", "Cooperlake", "SapphireRapids"};

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  return a.size() == b.size() && strncasecmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

std::string BlasKernelName() { return openblas_get_corename(); }

VectorInstructions InstructionsOfThisProcessor() {
  VectorInstructions instructions;
#if defined(__x86_64__)
  instructions.avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  instructions.avx512 = instructions.avx2 && __builtin_cpu_supports("avx512f") &&
                        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd");
#endif
  return instructions;
}

std::string BetterBlasKernels(const std::string& chosen, const VectorInstructions& processor) {
  const bool fast = std::any_of(kFastKernels.begin(), kFastKernels.end(),
                                [&](auto name) { return EqualIgnoringCase(name, chosen); });
  if (fast || !processor.avx2) return "";
  return processor.avx512 ? "SkylakeX" : "Haswell";
}

void RestartWithBlasKernels(const std::string& name, char** argv) {
  setenv(kVariable, name.c_str(), /*overwrite=*/1);
  // The restarted program blocks the signals again.
  const sigset_t mask = SignalMaskOfStartedPrograms();
  sigset_t own;
  pthread_sigmask(SIG_SETMASK, &mask, &own);
  execv("/proc/self/exe", argv);
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &own, nullptr);
  unsetenv(kVariable);
  std::cerr << "warning: OpenBLAS uses slow kernels (" << BlasKernelName()
            << ") and the program could not be restarted with better ones (" << std::strerror(error)
            << "); set the environment variable " << kVariable << "=" << name << " to use them\n";
}

void UseFastBlasKernels(char** argv) {
  if (std::getenv(kVariable) != nullptr) return;
  const std::string better = BetterBlasKernels(BlasKernelName(), InstructionsOfThisProcessor());
  if (!better.empty()) RestartWithBlasKernels(better, argv);
}

}  // namespace lacuna
