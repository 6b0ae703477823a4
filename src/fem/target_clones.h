// Functions that are compiled for several instruction sets and selected by the processor.
#ifndef LACUNA_FEM_TARGET_CLONES_H_
#define LACUNA_FEM_TARGET_CLONES_H_

// Placed before a function, it compiles the function for AVX-512, AVX2 and the baseline; the best
// version that the processor supports is selected at the start of the program. Versions for named
// architectures such as "arch=haswell" would not be selected on processors of other vendors.
//
// The selection runs before the thread sanitizer is ready for instrumented code, so that a program
// with such functions would crash at its start: under that sanitizer there is the baseline only.
#ifdef __SANITIZE_THREAD__
#define LACUNA_FOR_EACH_INSTRUCTION_SET
#else
#define LACUNA_FOR_EACH_INSTRUCTION_SET __attribute__((target_clones("avx512f", "avx2", "default")))
#endif

namespace lacuna {

// Neighbouring numbers in a vector register. Left to itself, the compiler unrolls short loops over
// three or four numbers and keeps scalars.
typedef double Two __attribute__((vector_size(2 * sizeof(double)), may_alias));
typedef double Four __attribute__((vector_size(4 * sizeof(double)), may_alias));
// Four numbers that are read from any address.
typedef double UnalignedFour
    __attribute__((vector_size(4 * sizeof(double)), may_alias, aligned(sizeof(double))));

// Two, three or four numbers from any address, the others 0. A register that is filled number by
// number goes through memory, which takes longer than what is computed with it. The result is not
// returned, because the registers for results depend on the instruction set.
template <int kCount>
[[gnu::always_inline]] inline void LoadFour(const double* from, Four* loaded) {
  static_assert(2 <= kCount && kCount <= 4);
  typedef double UnalignedTwo
      __attribute__((vector_size(2 * sizeof(double)), may_alias, aligned(sizeof(double))));
  const Two first = *reinterpret_cast<const UnalignedTwo*>(from);
  Two second = {0, 0};
  if constexpr (kCount == 4) second = *reinterpret_cast<const UnalignedTwo*>(from + 2);
  if constexpr (kCount == 3) second = Two{from[2], 0};
  *loaded = __builtin_shufflevector(first, second, 0, 1, 2, 3);
}

}  // namespace lacuna

#endif  // LACUNA_FEM_TARGET_CLONES_H_
