// Loops compiled for several instruction sets, of which the processor's best is taken.
#ifndef LACUNA_FEM_TARGET_CLONES_H_
#define LACUNA_FEM_TARGET_CLONES_H_

// In front of a function: it is compiled for AVX-512, AVX2 and the baseline, and the choice is made
// when the program starts, by what the processor can do. (Clones for named architectures, as
// "arch=haswell", would be passed over on other makers' processors.)
#define LACUNA_FOR_EACH_INSTRUCTION_SET __attribute__((target_clones("avx512f", "avx2", "default")))

#endif  // LACUNA_FEM_TARGET_CLONES_H_
