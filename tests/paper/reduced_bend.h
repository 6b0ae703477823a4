// A reduced bend for tests of the outer search: every fifth frame of the demo's recording.
#ifndef LACUNA_TESTS_PAPER_REDUCED_BEND_H_
#define LACUNA_TESTS_PAPER_REDUCED_BEND_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "paper/parameter_objective.h"
#include "paper/table1_scans.h"

namespace lacuna {

// The experiment, without its recording.
inline constexpr char kReducedBend[] = R"(schema_version: 1
name: reduced
frames: {last: 15, every: 5}
surface: {of_frames: poisson, edge_length: 8 mm, samples_per_node: 1.5, point_weight: 8}
mesh: {radius_edge_ratio: 2.0, max_volume: 300 mm^3, preserve_surface: false}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.35}
forces: {model: smooth, length: 60 mm, traction_scale: 0.1 kPa}
fit: {noise: 0.3 mm, alignment_rounds: 1}
)";

// The folder of its recording.
std::filesystem::path ReducedBendRecording();

// Tests on that experiment. Its frames are cleaned, turned into surfaces and registered once for
// each test suite.
class ReducedBendTest : public testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite() { scans_.reset(); }

  static const Table1Scans& Scans() { return *scans_; }
  // The objective of a search in `study`, which must outlive it: that of the experiment, or one
  // with the same frames.
  static ParameterObjective Problem(const ReconstructionStudy& study = Scans().study);

 private:
  static std::unique_ptr<const Table1Scans> scans_;
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_PAPER_REDUCED_BEND_H_
