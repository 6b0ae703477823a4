// Reading and writing of NumPy's array files (.npy, format 1.0 to 3.0).
//
// The reader accepts little-endian float64, float32, int64, int32, int16, uint32 and uint16, and
// int8 and uint8, in C or Fortran order, with any number of dimensions. The writer produces float64
// and int64.
#ifndef LACUNA_CORE_NPY_H_
#define LACUNA_CORE_NPY_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lacuna {

using MatrixXi64 = Eigen::Matrix<int64_t, Eigen::Dynamic, Eigen::Dynamic>;

// An array of any number of dimensions.
struct NpyArray {
  std::vector<int64_t> shape;  // empty for a single number
  std::vector<double> values;  // in C order (last index fastest), whatever the order in the file
};

// Reads an array as float64. All readers throw InputError naming the file if it is absent, is not
// an .npy file, has a different length than its header states, has an unsupported type, or contains
// int64 numbers beyond ±2^53 that are to be read as float64.
NpyArray ReadNpy(const std::filesystem::path& file);

// Reads a 2-D array as rows × columns and a 1-D array as one column. Throws InputError for any
// other number of dimensions.
Eigen::MatrixXd ReadNpyMatrix(const std::filesystem::path& file);
// Reads an array of integers in the shapes of ReadNpyMatrix(). Throws InputError for an array of
// floating-point numbers.
MatrixXi64 ReadNpyIntegers(const std::filesystem::path& file);

// Writes a 2-D array atomically in Fortran order; a matrix with one column stays 2-D. Throws
// InputError if the file cannot be written.
void WriteNpy(const std::filesystem::path& file, const Eigen::MatrixXd& matrix);
void WriteNpyIntegers(const std::filesystem::path& file, const MatrixXi64& matrix);

}  // namespace lacuna

#endif  // LACUNA_CORE_NPY_H_
