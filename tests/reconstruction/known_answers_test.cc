#include "reconstruction/known_answers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "support/box_mesh.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

// 0, 1, 2, … in C order, as NumPy writes them.
void WriteCounting(const std::filesystem::path& file, const std::vector<int>& shape) {
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}",
                                   fmt::join(shape, ", "));
  header.resize(117, ' ');
  header += '\n';
  std::ofstream stream(file, std::ios::binary);
  stream << "\x93NUMPY" << '\x01' << '\0' << '\x76' << '\0' << header;
  int count = 1;
  for (const int length : shape) count *= length;
  for (int i = 0; i < count; ++i) {
    const double value = i;
    stream.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
}

class KnownAnswers : public testing::Test {
 protected:
  // Eight nodes.
  KnownAnswers() {
    WriteTetMesh(folder_ / "box.msh", BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
    settings_.true_mesh = folder_ / "box.msh";
    settings_.true_positions = folder_ / "positions.npy";
    settings_.true_forces = folder_ / "forces.npy";
  }

  auto Positions(const std::vector<int>& shape, const std::vector<int>& frames) {
    WriteCounting(settings_.true_positions, shape);
    return [this, frames] { ReadTruePositions(settings_, frames); };
  }
  auto Forces(const std::vector<int>& shape, const std::vector<int>& frames) {
    WriteCounting(settings_.true_forces, shape);
    return [this, frames] { ReadTrueForces(settings_, frames); };
  }

  TemporaryFolder folder_;
  ValidationSettings settings_;
};

TEST_F(KnownAnswers, AreRefusedInAnotherUnitThanMetres) {
  const Eigen::Matrix3Xd seen = BoxMesh({0, 0, 0}, {0.07, 0.02, 0.02}, {1, 1, 1}).nodes;
  EXPECT_THAT([&] { RequireLengthUnit("truth.msh", 1000 * seen, seen); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("truth.msh"), HasSubstr("must be in m"))));
  EXPECT_THROW(RequireLengthUnit("truth.msh", seen.colwise() + Eigen::Vector3d(0, 1, 0), seen),
               InputError)
      << "elsewhere";
  EXPECT_NO_THROW(RequireLengthUnit("truth.msh", 2 * seen, seen.leftCols(4)));
}

TEST_F(KnownAnswers, AreReadFrameByFrame) {
  WriteCounting(settings_.true_positions, {3, 9, 3});
  const TruePositions positions = ReadTruePositions(settings_, {0, 2});
  ASSERT_EQ(positions.rest.cols(), 8);
  const Eigen::Matrix3Xd second = positions.At(2);
  ASSERT_EQ(second.cols(), 8);
  EXPECT_EQ(second.col(7), Eigen::Vector3d(2 * 27 + 21, 2 * 27 + 22, 2 * 27 + 23));
  WriteCounting(settings_.true_forces, {3, 3});
  EXPECT_EQ(ReadTrueForces(settings_, {0, 2}).row(1), Eigen::RowVector3d(3, 4, 5));
}

TEST_F(KnownAnswers, OfAnotherShapeAreRefused) {
  EXPECT_THAT(Forces({4, 2}, {0}),
              ThrowsMessage<InputError>(AllOf(HasSubstr("forces.npy: is an array of 4 × 2"),
                                              HasSubstr("expected frames × 3"))));
  EXPECT_THAT(Forces({3, 5}, {0}), ThrowsMessage<InputError>(HasSubstr("an array of 3 × 5")));
  EXPECT_THAT(Forces({4, 3}, {0, 4}),
              ThrowsMessage<InputError>(HasSubstr("has 4 frames, from 0; frame 4 is followed")));
  EXPECT_THAT(Positions({2, 8, 2}, {0}), ThrowsMessage<InputError>(HasSubstr("frames × points × "
                                                                             "3")));
  EXPECT_THAT(Positions({2, 5, 3}, {0}),
              ThrowsMessage<InputError>(AllOf(HasSubstr("positions.npy: has 5 points"),
                                              HasSubstr("box.msh use 8 nodes"))));
  EXPECT_THAT(Positions({2, 8, 3}, {0, 2}),
              ThrowsMessage<InputError>(HasSubstr("frame 2 is followed")));
}

TEST(KnownSurfaces, AreInputsFrameByFrame) {
  ValidationSettings settings;
  settings.true_surfaces =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend/truth";
  std::vector<std::string> names;
  for (const auto& [name, file] : FilesOfKnownAnswers(settings, {0, 5})) {
    names.push_back(name);
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
  }
  EXPECT_THAT(names,
              testing::ElementsAre("true_surfaces/triangles.npy", "true_surfaces/vertices_000.npy",
                                   "true_surfaces/vertices_005.npy"));
  EXPECT_GT(ReadTrueSurface(settings, 5).vertices.cols(), 100);
}

}  // namespace
}  // namespace lacuna
