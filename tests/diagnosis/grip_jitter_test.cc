#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <random>
#include <variant>

#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr double kRatio = 0.42;
constexpr double kNoise = 2e-5;  // m

// A bar is stretched uniformly by two grips, whose motion is known from noisy markers. The nuisance
// is as large as the error that this noise causes in the predicted motion between the grips.
TEST(GripJitter, IsAsLargeAsTheMarkersNoiseMakesIt) {
  const TemporaryFolder folder;
  WriteBox(folder / "box.off");
  std::vector<Eigen::Vector3d> places;
  for (const double x : {0.0, 0.08, 0.02, 0.03, 0.04, 0.05, 0.06})
    for (const double y : {-0.01, 0.01})
      for (const double z : {-0.01, 0.01}) places.emplace_back(x, y, z);
  std::ofstream yaml(folder / "recording.yaml");
  yaml << "schema_version: 1\nname: stretched\nlength_unit: m\ndensity: 1000 kg/m^3\nframes:\n"
          "  kind: markers\n  file: markers.csv\n  columns: {time: t}\n  marker_places:\n";
  std::ofstream csv(folder / "markers.csv");
  csv << "t";
  for (size_t m = 0; m < places.size(); ++m) {
    yaml << fmt::format("    - {{name: m{}, position: [{} m, {} m, {} m]}}\n", m, places[m].x(),
                        places[m].y(), places[m].z());
    csv << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  }
  yaml << R"(reference: {from: mesh, file: box.off}
gripped:
  - {half_space: {point: [0.1 mm, 0 m, 0 m], normal: [-1, 0, 0]}, follows_markers: [m0, m1, m2, m3], deforms: true}
  - {half_space: {point: [79.9 mm, 0 m, 0 m], normal: [1, 0, 0]}, follows_markers: [m4, m5, m6, m7], deforms: true}
)";
  yaml.close();
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, kNoise);
  for (int frame = 0; frame < 21; ++frame) {
    const double stretch = 0.001 * frame;
    csv << fmt::format("\n{}", frame);
    for (size_t m = 0; m < places.size(); ++m) {
      const double error = m < 8 ? 1 : 0;  // of the grips' markers alone
      csv << fmt::format(",{},{},{}", (1 + stretch) * places[m].x() + error * noise(random),
                         (1 - kRatio * stretch) * places[m].y() + error * noise(random),
                         (1 - kRatio * stretch) * places[m].z() + error * noise(random));
    }
  }
  csv << "\n";
  csv.close();
  const PredictionStudy study = ReadPredictionStudy(Config::Parse(
      fmt::format(
          "schema_version: 1\nname: stretched\nmesh: {{max_volume: 1000 mm^3, order: 2}}\n"
          "material: {{law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.42}}\n"
          "motion: {{scheme: quasi_static}}\nnoise: {} m\nplace_deviation: 0.1 mm\n"
          "fit: {{parameters: [{{name: poisson_ratio}}]}}\nrecordings: [{{recording: {}}}]\n",
          kNoise, (folder / "recording.yaml").string()),
      (folder / "study.yaml").string()));
  const CalibrationProblem problem(study, BarMesh({7, 1, 1}, 2));
  const Eigen::VectorXd start = problem.Start();
  const LinearisedWithGrips linearised = LineariseWithGrips(problem, start, {});
  const GripMotions& grips = linearised.grips;
  const LinearisedMisfit& misfit = linearised.misfit;
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const Eigen::MatrixXd grip_columns = linearised.OfGrips();
  const std::vector<NuisanceCandidate> nuisances =
      ModelNuisances({problem, start, misfit, grips, grip_columns});
  const auto jitter = std::find_if(nuisances.begin(), nuisances.end(), [](const auto& nuisance) {
    return nuisance.card.name == "grip_jitter";
  });
  ASSERT_NE(jitter, nuisances.end());
  EXPECT_EQ(jitter->columns.cols(), 21 * 2 * (3 + 6));
  double seen = 0, expected = 0;
  const Eigen::Index series = 3 * static_cast<Eigen::Index>(places.size());
  for (Eigen::Index row = 0; row < misfit.residual.size(); ++row) {
    if (row % series < 3 * 8) continue;
    seen += misfit.residual[row] * misfit.residual[row];
    expected += jitter->columns.row(row).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(seen / expected), 1, 0.25);
  EXPECT_TRUE(jitter->left_out.empty());

  // With too many frames for a column each, the recording is named instead.
  LinearisedMisfit many = misfit;
  many.parts.front().layout.times.resize(kThresholds.nuisances.most_single_frames + 1);
  // With too many rows for the columns of all frames, it says how much memory these would need.
  LinearisedMisfit large = misfit;
  large.residual.resize(500'000);
  for (const NuisanceEntry& entry : NuisanceCatalogue()) {
    if (entry.card.name != "grip_jitter") continue;
    const auto make = [&](const LinearisedMisfit& along) {
      return std::get<ModelNuisance>(entry.make)({problem, start, along, grips, grip_columns});
    };
    const std::optional<NuisanceCandidate> of_many = make(many), of_large = make(large);
    ASSERT_TRUE(of_many.has_value() && of_large.has_value());
    EXPECT_EQ(of_many->columns.cols(), 0);
    EXPECT_THAT(of_many->left_out, testing::ElementsAre(study.recordings.front().name));
    EXPECT_EQ(of_large->columns.cols(), 0);
    EXPECT_THAT(of_large->untried, testing::HasSubstr("1.5 GB"));
  }
}

}  // namespace
}  // namespace lacuna
