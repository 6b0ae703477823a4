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

#endif  // LACUNA_FEM_TARGET_CLONES_H_
