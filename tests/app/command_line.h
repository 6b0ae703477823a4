// The program `lacuna` as the tests start it, and a small scene for it.
#ifndef LACUNA_TESTS_APP_COMMAND_LINE_H_
#define LACUNA_TESTS_APP_COMMAND_LINE_H_

#include <filesystem>
#include <fstream>
#include <string>

#include "support/ended_program.h"
#include "support/temporary_folder.h"

namespace lacuna {

inline Ending Lacuna(const std::string& arguments) {
  return EndingOf(std::string(LACUNA_PROGRAM) + " " + arguments);
}

// A file or folder of the bundled experiments.
inline std::string Experiment(const std::string& name) {
  return std::string(LACUNA_SOURCE_DIR) + "/experiments/" + name;
}

// A bar of few elements that is bent in two frames and scanned.
inline std::string WriteSmallScene(const TemporaryFolder& folder) {
  const std::filesystem::path file = folder / "scene.yaml";
  std::ofstream(file) << R"(schema_version: 1
name: small
bar: {size: [100 mm, 30 mm, 30 mm], edge_radius: 5 mm, edge_length: 10 mm}
mesh: {max_volume: 500 mm^3}
density: 1000 kg/m^3
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
grips: [{region: {name: clamp, half_space: {point: [-40 mm, 0 mm, 0 mm], normal: [-1, 0, 0]}}}]
loads: [{region: {half_space: {point: [40 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}, force: [0 N, 0 N, -0.3 N]}]
motion: {frame_rate: 20 Hz, frames: 3, steps_per_frame: 1}
scanner: {cameras: 2, look_at: [0 m, 0 m, 0 m], distance: 0.4 m, field_of_view: 24 deg, noise: 0.3 mm}
)";
  return file;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_APP_COMMAND_LINE_H_
