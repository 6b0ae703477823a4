// Random numbers without a state: each is a function of a few whole numbers, e.g. of a seed, a
// frame and a pixel. They can therefore be drawn in any order and by any thread with the same
// result.
#ifndef LACUNA_CORE_RANDOM_BITS_H_
#define LACUNA_CORE_RANDOM_BITS_H_

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

namespace lacuna {

// 64 uniformly distributed bits: the finaliser of SplitMix64 (Steele, Lea & Flood 2014) applied to
// one key after another.
inline uint64_t RandomBits(std::initializer_list<uint64_t> keys) {
  uint64_t state = 0;
  for (const uint64_t key : keys) {
    state += key + 0x9e3779b97f4a7c15u;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
    state ^= state >> 31;
  }
  return state;
}

// A number uniformly distributed in the open interval (0, 1).
inline double Uniform(uint64_t bits) { return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52; }

// A normally distributed number with mean 0 and standard deviation 1 (Box & Muller 1958).
inline double Normal(uint64_t bits) {
  const double radius = std::sqrt(-2 * std::log(Uniform(bits)));
  return radius * std::cos(2 * std::numbers::pi * Uniform(RandomBits({bits, 1})));
}

}  // namespace lacuna

#endif  // LACUNA_CORE_RANDOM_BITS_H_
