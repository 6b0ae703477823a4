#include "core/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class Npy : public ::testing::Test {
 protected:
  // Writes a file like NumPy, from a header and a payload.
  template <typename Number>
  fs::path WriteByHand(const std::string& dictionary, const std::vector<Number>& numbers,
                       int version = 1) {
    std::string header = dictionary + "\n";
    std::string bytes = "\x93NUMPY";
    bytes += {static_cast<char>(version), 0};
    const uint32_t length = static_cast<uint32_t>(header.size());
    bytes.append(reinterpret_cast<const char*>(&length), version == 1 ? 2 : 4);
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
    const fs::path file = folder_ / "by_hand.npy";
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

  const TemporaryFolder folder_;
};

TEST_F(Npy, DoublesAreReadBackBitForBit) {
  Eigen::MatrixXd matrix(2, 3);
  matrix << 0.1, -0.0, 1e-310, std::numeric_limits<double>::infinity(), std::nan(""), 3;
  WriteNpy(folder_ / "a.npy", matrix);
  const Eigen::MatrixXd read = ReadNpyMatrix(folder_ / "a.npy");
  ASSERT_EQ(read.rows(), 2);
  ASSERT_EQ(read.cols(), 3);
  EXPECT_EQ(std::memcmp(read.data(), matrix.data(), 6 * sizeof(double)), 0);
}

TEST_F(Npy, IntegersBeyondDoublePrecisionAreReadBackExactly) {
  MatrixXi64 matrix(1, 2);
  matrix << (int64_t{1} << 53) + 1, std::numeric_limits<int64_t>::min();
  WriteNpyIntegers(folder_ / "a.npy", matrix);
  EXPECT_EQ(ReadNpyIntegers(folder_ / "a.npy"), matrix);
  EXPECT_THAT([&] { ReadNpy(folder_ / "a.npy"); },
              ThrowsMessage<InputError>(HasSubstr("9007199254740993")));
}

TEST_F(Npy, EmptyMatrixKeepsItsShape) {
  WriteNpy(folder_ / "a.npy", Eigen::MatrixXd(3, 0));
  const Eigen::MatrixXd read = ReadNpyMatrix(folder_ / "a.npy");
  EXPECT_EQ(read.rows(), 3);
  EXPECT_EQ(read.cols(), 0);
}

TEST_F(Npy, PayloadIsAlignedAsTheFormatRequires) {
  WriteNpy(folder_ / "a.npy", Eigen::MatrixXd::Zero(1, 1));
  EXPECT_EQ((fs::file_size(folder_ / "a.npy") - sizeof(double)) % 64, 0u);
}

TEST_F(Npy, BothOrdersGiveTheSameMatrix) {
  const std::vector<int32_t> numbers{1, 2, 3, 4, 5, 6};
  const Eigen::MatrixXd c = ReadNpyMatrix(
      WriteByHand("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3), }", numbers));
  EXPECT_EQ(c(0, 1), 2);
  EXPECT_EQ(c(1, 0), 4);
  const Eigen::MatrixXd fortran = ReadNpyMatrix(
      WriteByHand("{'descr': '<i4', 'fortran_order': True, 'shape': (2, 3), }", numbers));
  EXPECT_EQ(fortran(0, 1), 3);
  EXPECT_EQ(fortran(1, 0), 2);
}

TEST_F(Npy, ThreeDimensionsAreReadWithTheLastIndexFastest) {
  // In Fortran order the first index runs fastest: a(i, j, k) = 1 + i + 2 j + 4 k here.
  const NpyArray array = ReadNpy(WriteByHand<float>(
      "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2, 2), }", {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_THAT(array.shape, ElementsAre(2, 2, 2));
  EXPECT_THAT(array.values, ElementsAre(1, 5, 3, 7, 2, 6, 4, 8));
}

TEST_F(Npy, VectorIsAColumnAndVersionTwoIsRead) {
  const Eigen::MatrixXd column = ReadNpyMatrix(WriteByHand<uint16_t>(
      "{'descr': '<u2', 'fortran_order': False, 'shape': (3,), }", {7, 8, 65535}, 2));
  ASSERT_EQ(column.rows(), 3);
  ASSERT_EQ(column.cols(), 1);
  EXPECT_EQ(column(2, 0), 65535);
}

TEST_F(Npy, BrokenFilesAreRefusedWithTheirCause) {
  const auto expect = [](const fs::path& file, const std::string& cause) {
    EXPECT_THAT([&] { ReadNpyMatrix(file); }, ThrowsMessage<InputError>(::testing::AllOf(
                                                  HasSubstr(file.string()), HasSubstr(cause))));
  };
  expect(folder_ / "absent.npy", "no such file");
  const std::vector<double> two{1, 2};
  const std::string good = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
  const fs::path file = WriteByHand(good, two);
  fs::resize_file(file, fs::file_size(file) - 1);
  expect(file, "15 bytes of numbers; its shape requires 16");
  fs::resize_file(file, 30);
  expect(file, "ends within");
  fs::resize_file(file, 4);
  expect(file, "is not an .npy file");
  expect(WriteByHand("{'descr': '>f8', 'fortran_order': False, 'shape': (2,), }", two), "'>f8'");
  expect(WriteByHand("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }", two),
         "requires 24");
  expect(WriteByHand("{'descr': '<f8', 'shape': (2,), }", two), "order");
  expect(WriteByHand(
             "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 99999999999)}", two),
         "impossible shape");
  expect(WriteByHand("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 2), }", two),
         "3 dimensions");
  expect(WriteByHand(good, two, 9), "version");
  EXPECT_THAT([&] { ReadNpyIntegers(WriteByHand(good, two)); },
              ThrowsMessage<InputError>(HasSubstr("integers are expected")));
}

}  // namespace
}  // namespace lacuna
