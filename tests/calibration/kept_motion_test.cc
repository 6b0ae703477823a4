#include "calibration/kept_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_run.h"
#include "core/hash.h"
#include "prediction/prediction_study_reader.h"
#include "record/motion_record.h"
#include "record/packed_array.h"
#include "support/scanned_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// A fit of nothing but nuisance parameters, in <folder>/run.
std::filesystem::path FitBar(const TemporaryFolder& folder) {
  std::ofstream(folder / "study.yaml")
      << BarExperiment(folder.Path(), {{"name: bar\nmesh", "name: bar\noutput: run\nmesh"},
                                       {"{name: young_modulus}, {name: mass_damping.alpha}", ""},
                                       {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
                                       {"alpha: 1 1/s", "alpha: 2 1/s"}});
  SilentProgress progress;
  const CalibrationRecord record =
      RunCalibration(ReadPredictionStudy(Config::Load(folder / "study.yaml")), &progress);
  EXPECT_TRUE(record.usable) << record.message;
  return folder / "run";
}

TEST(KeptMotion, ShowsTheSurfaceInEveryFrame) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  WriteBarRecording(folder.Path(), markers);
  const std::filesystem::path run = FitBar(folder);
  SilentProgress progress;
  KeepMotion(run, &progress);
  const std::string written = FileContent(MotionFile(run, 0));
  const StoredMotion motion = ReadMotionFile(MotionFile(run, 0));
  EXPECT_EQ(motion.fit, HashFile(run / "calibration/calibration.json"));
  EXPECT_EQ(motion.times.size(), static_cast<size_t>(kFrames));
  EXPECT_NEAR(motion.times.at(7).get<double>(), 0.07, 1e-9);
  EXPECT_EQ(motion.up, nlohmann::json({0.0, 0.0, 1.0}));
  EXPECT_THAT(motion.notes, testing::IsEmpty());

  // The last marker is near the upper edge of the bar's end: some vertex follows it in each frame.
  const Eigen::MatrixXd positions = Unpack(motion.surface.at("positions")).values;
  const Eigen::VectorXd rest = positions.col(0);
  Eigen::Index near = 0;
  (rest.reshaped(3, rest.size() / 3).colwise() - markers[0].col(kMarkers - 1))
      .colwise()
      .norm()
      .minCoeff(&near);
  for (int f = 0; f < kFrames; ++f) {
    const Eigen::Vector3d moved = positions.col(f).segment<3>(3 * near) - rest.segment<3>(3 * near);
    const Eigen::Vector3d measured =
        markers[static_cast<size_t>(f)].col(kMarkers - 1) - markers[0].col(kMarkers - 1);
    // The model's mesh is coarse, and the vertex is up to 1 cm away from the marker.
    EXPECT_LT((moved - measured).norm(), 0.003) << f;
  }
  const nlohmann::json& strain = motion.surface.at("fields").at(2);
  EXPECT_EQ(strain.at("name"), "strain");
  EXPECT_GT(strain.at("high").get<double>(), 0.01);
  EXPECT_LT(strain.at("high").get<double>(), 0.3);

  // It is of this fit already: the file is not written again.
  std::filesystem::last_write_time(MotionFile(run, 0), {});
  KeepMotion(run, &progress);
  EXPECT_EQ(std::filesystem::last_write_time(MotionFile(run, 0)),
            std::filesystem::file_time_type());
  // One of another fit is.
  std::string other = written;
  other.replace(other.find(motion.fit), motion.fit.size(), "0");
  std::ofstream(MotionFile(run, 0)) << other;
  KeepMotion(run, &progress);
  EXPECT_EQ(FileContent(MotionFile(run, 0)), written);
}

TEST(KeptMotion, ShowsTheSurfaceOfABarThatWasScanned) {
  const TemporaryFolder folder;
  WriteBarScans(folder.Path(), HeldBarSurfaces({}),
                "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, "
                "0]}}]\nreference: {from: mesh, file: box.off}\n");
  const std::filesystem::path run = FitBar(folder);
  SilentProgress progress;
  KeepMotion(run, &progress);
  const StoredMotion motion = ReadMotionFile(MotionFile(run, 0));
  EXPECT_EQ(motion.times.size(), static_cast<size_t>(kScans));
  EXPECT_EQ(Unpack(motion.surface.at("positions")).shape[0], kScans);
  EXPECT_GT(motion.surface.at("fields").at(0).at("high").get<double>(), 0.002);  // it hangs down
}

}  // namespace
}  // namespace lacuna
