// A sweep whose cases run quickly: a bar with few points in two frames.
#ifndef LACUNA_TESTS_SWEEP_SMALL_SWEEP_H_
#define LACUNA_TESTS_SWEEP_SMALL_SWEEP_H_

#include <filesystem>
#include <fstream>
#include <string>

#include "core/config.h"
#include "sweep/sweep_plan.h"

namespace lacuna {

// Writes recording/, bend.yaml and sweep.yaml; the given lines follow the head of the latter.
inline std::filesystem::path WriteSmallSweep(const std::filesystem::path& folder,
                                             const std::string& lines) {
  const std::filesystem::path recording = folder / "recording";
  std::filesystem::create_directories(recording);
  for (const char* frame : {"a.xyz", "b.xyz"}) {
    std::ofstream points(recording / frame);
    for (int k = 0; k < 40; ++k) points << k % 10 << " " << k / 10 % 2 << " " << k / 20 << "\n";
  }
  std::ofstream(recording / "recording.yaml") << R"(schema_version: 1
name: bar
length_unit: cm
density: 1000 kg/m^3
frames: {kind: points, files: [a.xyz, b.xyz], rate: 10 Hz}
)";
  std::ofstream(folder / "bend.yaml") << R"(schema_version: 1
name: bend
recording: recording
mesh: {max_volume: 150 mm^3}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.35}
forces: {model: smooth}
)";
  std::ofstream(folder / "sweep.yaml") << "schema_version: 1\nname: small\ncommand: reconstruct\n"
                                       << "experiments: bend.yaml\n"
                                       << lines;
  return folder / "sweep.yaml";
}

inline SweepPlan PlanSmallSweep(const std::filesystem::path& folder, const std::string& lines) {
  return PlanSweep(Config::Load(WriteSmallSweep(folder, lines)), folder / "cases");
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SWEEP_SMALL_SWEEP_H_
