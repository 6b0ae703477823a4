// The commands that are disturbed, with experiments so small that a run takes some seconds.
#include <fstream>

#include "core/error.h"
#include "faults/faults.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// The first frames of the demo.
constexpr char kSmallBend[] = R"(use: bend.yaml
name: small_bend
output: ../results/small_bend
frames: {last: 3}
)";

// One recording of the demo, with few elements, so that a fit and a diagnosis take seconds. What
// the diagnosis says does not matter here.
constexpr char kSmallEffect[] = R"(use: hidden_effect.yaml
name: small_effect
output: ../results/small_effect
mesh: {max_volume: 8000 mm^3, order: 1, preserve_surface: false}
recordings:
  - recording: recordings/hidden_effect/recording_1
    fit_until: 0.451 s
    hold:
      release: 0.1037 s
      region: {half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}
)";

constexpr char kSmallSweep[] = R"(schema_version: 1
name: small_sweep
command: reconstruct
experiments: bend.yaml
cases:
  - {frames.last: 1, mesh.max_volume: 600 mm^3, surface.edge_length: 8 mm}
  - {frames.last: 2, mesh.max_volume: 600 mm^3, surface.edge_length: 8 mm}
)";

// The scene of Table 1 with few elements, frames and pixels.
constexpr char kSmallScene[] = R"(schema_version: 1
name: small_table1
bar:
  centre: [0.5 m, 0.15 m, 0.15 m]
  size: [1 m, 0.3 m, 0.3 m]
  edge_radius: 50 mm
  edge_length: 80 mm
mesh: {radius_edge_ratio: 2, max_volume: 1000 cm^3}
density: 1000 kg/m^3
material: {use: ../../configs/material/paper.yaml}
effects: []
grips:
  - region: {name: clamp, half_space: {point: [80 mm, 0 mm, 0 mm], normal: [-1, 0, 0]}}
loads:
  - region: {name: tip, half_space: {point: [0.92 m, 0 m, 0 m], normal: [1, 0, 0]}}
    force: [0 N, 150 N, -400 N]
    profile: {times: [0 s, 0.2 s], values: [0, 1]}
    measured: true
motion: {frame_rate: 12 Hz, frames: 3, steps_per_frame: 2}
scanner:
  use: ../../configs/scanner/four_cameras.yaml
  distance: 4 m
  noise: 1 mm
  quantum: 0.5 mm
  width: 72
  height: 54
  look_at: [0.5 m, 0.15 m, 0.1 m]
)";

constexpr char kSmallTable1[] = R"(schema_version: 1
scene: ../scenes/small_table1.yaml
filter: {outlier_neighbours: 16, outlier_deviations: 2}
surface: {of_frames: poisson, edge_length: 90 mm}
mesh: {radius_edge_ratio: 2.0, max_volume: 1000 cm^3}
material: {law: corotational, young_modulus: 1 MPa, poisson_ratio: 0.3}
motion: {scheme: implicit_euler}
forces:
  model: footprint
  region: {name: tip, half_space: {point: [0.92 m, 0 m, 0 m], normal: [1, 0, 0]}}
  force_scale: 1 kN
fit: {noise: 1 mm, alignment_rounds: 1}
)";

constexpr char kGeometryRow[] = R"(row: 1
name: geometry
search:
  radius_edge_ratio: {start: 2.0, lower: 1.42, upper: 3.0}
  max_volume: {start: 1000 cm^3, lower: 400 cm^3, upper: 3000 cm^3}
  young_modulus: {start: 1 MPa}
  poisson_ratio: {start: 0.3}
  evaluations: 6
)";

constexpr char kMaterialRow[] = R"(row: 2
name: material
search:
  radius_edge_ratio: {start: 2.0}
  max_volume: {start: 1000 cm^3}
  young_modulus: {start: 0.5 MPa, lower: 0.1 MPa, upper: 10 MPa}
  poisson_ratio: {start: 0.3, lower: 0.05, upper: 0.48}
  evaluations: 6
)";

void WriteText(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file);
  stream << text << std::flush;
  if (!stream) throw InputError({file.string()}, "cannot be written");
}

}  // namespace

std::vector<Subject> BundledSubjects() {
  const std::vector<std::string> fit{"fit", "experiments/small_effect.yaml"};
  const fs::path points = "experiments/recordings/bend/frames/points_001.ply";
  const fs::path markers = "experiments/recordings/hidden_effect/recording_1/markers.csv";
  return {{.name = "reconstruct",
           .arguments = {"reconstruct", "experiments/small_bend.yaml"},
           .results = "results/small_bend",
           .input = points},
          {.name = "fit", .arguments = fit, .results = "results/small_effect", .input = markers},
          {.name = "diagnose",
           .arguments = {"diagnose", "results/small_effect", "--refits", "1"},
           .results = "results/small_effect",
           .preparation = fit,
           .preparation_mends = true,
           .input = markers,
           .reads_input_late = false},
          {.name = "table1",
           .arguments = {"table1", "experiments/small_table1", "--turns", "1", "--output",
                         "results/small_table1"},
           .results = "results/small_table1",
           .input = "experiments/scenes/small_table1.yaml",
           .reads_input_late = false,
           .refused_words = "is being worked on by"},
          // A case that has failed, as on a full disk, is run again where that is asked for.
          {.name = "sweep",
           .arguments = {"sweep", "run", "results/small_sweep", "--workers", "2", "--retry-failed"},
           .results = "results/small_sweep",
           .preparation = {"sweep", "plan", "experiments/small_sweep.yaml", "results/small_sweep"},
           .input = points,
           .manifests = 2,
           .refusal = 1,
           .mark = "outcome.json",
           .refused_words = "cases are unfinished"}};
}

void WriteExperiments(const fs::path& sources, const fs::path& folder) {
  const fs::path experiments = folder / "experiments";
  fs::create_directories(experiments / "recordings");
  constexpr auto kAll = fs::copy_options::recursive;
  for (const char* name : {"bend", "hidden_effect"}) {
    const std::string file = std::string(name) + ".yaml";
    fs::copy_file(sources / "experiments" / file, experiments / file);
    fs::copy(sources / "experiments/recordings" / name, experiments / "recordings" / name, kAll);
  }
  fs::copy(sources / "configs", folder / "configs", kAll);
  WriteText(experiments / "small_bend.yaml", kSmallBend);
  WriteText(experiments / "small_effect.yaml", kSmallEffect);
  WriteText(experiments / "small_sweep.yaml", kSmallSweep);
  WriteText(experiments / "scenes/small_table1.yaml", kSmallScene);
  WriteText(experiments / "small_table1/geometry.yaml", std::string(kGeometryRow) + kSmallTable1);
  WriteText(experiments / "small_table1/material.yaml", std::string(kMaterialRow) + kSmallTable1);
}

}  // namespace lacuna
