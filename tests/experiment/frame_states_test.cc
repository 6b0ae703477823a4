// What is doubtful about a frame stays with its state.
#include "experiment/frame_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A flat sheet in two frames, seen from an unknown side; in the second frame one of the given
// normals is zero.
Recording FlatSheets(const TemporaryFolder& folder) {
  const TriMesh sheet = FlatSheet(0.1, 0.05, 20, 10);
  std::ofstream plain(folder / "p0.csv"), with_normals(folder / "p1.csv");
  plain << "x,y,z\n";
  with_normals << "x,y,z,nx,ny,nz\n";
  bool is_first = true;
  for (const auto p : sheet.vertices.colwise()) {
    plain << p.x() << ',' << p.y() << ',' << p.z() << '\n';
    with_normals << p.x() << ',' << p.y() << ',' << p.z() << ",0,0," << (is_first ? 0 : 1) << '\n';
    is_first = false;
  }
  plain.close();
  with_normals.close();
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nlength_unit: m\n"
         "frames: {kind: points, files: [p0.csv, p1.csv], rate: 1 Hz}\n";
  return LoadRecording(folder.Path());
}

TEST(FrameStates, KeepDoubtsAboutNormals) {
  const TemporaryFolder folder;
  const Recording recording = FlatSheets(folder);
  FrameStateOptions options;
  options.surfaces = false;
  const std::vector<FrameState> states{MakeFrameState(recording, 0, options),
                                       MakeFrameState(recording, 1, options)};
  EXPECT_THAT(states[0].notes, Contains(HasSubstr("which side is outside is uncertain for 1 of ")));
  EXPECT_THAT(states[1].notes, Contains(HasSubstr("p1.csv: 1 of 231 normals are zero")));

  std::filesystem::create_directories(folder / "states");
  WriteFrameStates(states, folder / "states");
  const std::vector<FrameState> read = ReadFrameStates(folder / "states");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].notes, states[0].notes);
  EXPECT_EQ(read[1].notes, states[1].notes);
}

}  // namespace
}  // namespace lacuna
