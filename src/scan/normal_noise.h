// Normal noise of simulated measurements.
#ifndef LACUNA_SCAN_NORMAL_NOISE_H_
#define LACUNA_SCAN_NORMAL_NOISE_H_

#include <Eigen/Core>
#include <cstdint>

#include "core/random_bits.h"

namespace lacuna {

// Where noise comes from: other numbers give independent noise.
struct NoiseSource {
  uint64_t seed = 0;
  uint64_t stream = 0;  // the kind of measurement
  uint64_t number = 0;  // of the instrument or the frame
};

// Adds to each entry of `values` an independent normal draw with this standard deviation, in the
// unit of the values. That of entry k, counted along the columns, depends on the source and k
// alone.
inline void AddNormalNoise(double deviation, const NoiseSource& source,
                           Eigen::Ref<Eigen::MatrixXd> values) {
  uint64_t k = 0;
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    for (Eigen::Index row = 0; row < values.rows(); ++row)
      values(row, column) +=
          deviation * Normal(RandomBits({source.seed, source.stream, source.number, k++}));
}

}  // namespace lacuna

#endif  // LACUNA_SCAN_NORMAL_NOISE_H_
