// NumPy's array files (.npy, format 1.0 to 3.0): large arrays that Lacuna and Python both read.
//
// Read: little-endian float64, float32, int64, int32, int16, uint32, uint16 and single bytes, in
// C or Fortran order, of any number of dimensions. Written: float64 and int64.
#ifndef LACUNA_CORE_NPY_H_
#define LACUNA_CORE_NPY_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lacuna {

using MatrixXi64 = Eigen::Matrix<int64_t, Eigen::Dynamic, Eigen::Dynamic>;

struct NpyArray {
  std::vector<int64_t> shape;  // empty for a single number
  std::vector<double> values;  // last index fastest, whatever the order in the file
};

// Each throws InputError naming the file when it is absent, not an .npy file, shorter or longer
// than its header says, of another type, or (integers read as float64) beyond ±2^53.
NpyArray ReadNpy(const std::filesystem::path& file);

// A 2-D array as rows × columns, a 1-D array as a column; another shape is an InputError.
Eigen::MatrixXd ReadNpyMatrix(const std::filesystem::path& file);
// The same for an integer type; an array of floating-point numbers is an InputError.
MatrixXi64 ReadNpyIntegers(const std::filesystem::path& file);

// Written atomically, in Fortran order. A matrix becomes a 2-D array, also when it has one column.
void WriteNpy(const std::filesystem::path& file, const Eigen::MatrixXd& matrix);
void WriteNpyIntegers(const std::filesystem::path& file, const MatrixXi64& matrix);

}  // namespace lacuna

#endif  // LACUNA_CORE_NPY_H_
