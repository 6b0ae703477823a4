#include "core/blas_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

namespace lacuna {
namespace {

// The output of the probe program, run with this environment ("NAME=value") and these arguments.
std::string RunProbe(const std::string& environment, const std::string& arguments) {
  const std::string command =
      "env -u OPENBLAS_CORETYPE " + environment + " '" LACUNA_BLAS_PROBE "' " + arguments;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string output;
  std::array<char, 256> buffer;
  while (fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) output += buffer.data();
  return output;
}

TEST(BlasKernels, AreReplacedIfTheProcessorSupportsFasterOnes) {
  const VectorInstructions none, avx2{.avx2 = true}, avx512{.avx2 = true, .avx512 = true};
  EXPECT_EQ(BetterBlasKernels("Prescott", avx512), "SkylakeX");
  EXPECT_EQ(BetterBlasKernels("Prescott", avx2), "Haswell");
  EXPECT_EQ(BetterBlasKernels("Sandybridge", avx2), "Haswell");
  EXPECT_EQ(BetterBlasKernels("Prescott", none), "");
  for (const char* fast : {"Haswell", "Zen", "SkylakeX", "Cooperlake", "haswell"}) {
    EXPECT_EQ(BetterBlasKernels(fast, avx512), "") << fast;
  }
}

TEST(BlasKernels, InUseAreFastAfterTheProgramHasChecked) {
  const std::string name = RunProbe("", "");
  ASSERT_FALSE(name.empty());
  EXPECT_EQ(BetterBlasKernels(name, InstructionsOfThisProcessor()), "") << name;
}

TEST(BlasKernels, ChosenByTheUserAreKept) {
  EXPECT_EQ(RunProbe("OPENBLAS_CORETYPE=Nehalem", "a"), "Nehalem|a");
}

TEST(BlasKernels, AreChangedByARestartWithTheSameArguments) {
  EXPECT_EQ(RunProbe("", "restart 'two words' '' --last"), "Nehalem|restart|two words||--last");
}

}  // namespace
}  // namespace lacuna
