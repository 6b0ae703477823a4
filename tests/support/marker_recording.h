// Parts of a recording of a box whose points are tracked, as files.
#ifndef LACUNA_TESTS_SUPPORT_MARKER_RECORDING_H_
#define LACUNA_TESTS_SUPPORT_MARKER_RECORDING_H_

#include <fmt/format.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <string>

namespace lacuna {

// The surface of a box, twelve triangles, as an OFF file.
inline void WriteBoxSurface(const std::filesystem::path& file, const Eigen::Vector3d& low,
                            const Eigen::Vector3d& high) {
  std::ofstream off(file);
  off << "OFF\n8 12 0\n";
  for (int corner = 0; corner < 8; ++corner)
    off << fmt::format("{} {} {}\n", (corner & 1 ? high : low).x(), (corner & 2 ? high : low).y(),
                       (corner & 4 ? high : low).z());
  for (const char* face : {"0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7",
                           "0 4 2", "2 4 6", "1 3 5", "3 7 5"})
    off << "3 " << face << '\n';
}

// The entry `frames` of recording.yaml, for markers m0, m1, … in markers.csv at these places of the
// undeformed object (3 × markers, m).
inline std::string MarkerFrames(const Eigen::Matrix3Xd& places) {
  std::string yaml = R"(frames:
  kind: markers
  file: markers.csv
  columns: {time: t}
  marker_places:
)";
  for (Eigen::Index m = 0; m < places.cols(); ++m)
    yaml += fmt::format("    - {{name: m{}, position: [{} m, {} m, {} m]}}\n", m, places(0, m),
                        places(1, m), places(2, m));
  return yaml;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_MARKER_RECORDING_H_
