#include "comparison/comparison_files.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "analysis/residual_statistics.h"
#include "comparison/part_comparison.h"
#include "core/atomic_file.h"
#include "report/comparison_report.h"

namespace lacuna {
namespace {

// The number of lengths that are not NaN, and the largest of them.
struct KnownLengths {
  int count = 0;
  double largest = kUnknown;

  void Add(double length) {
    count += !std::isnan(length);
    largest = std::fmax(largest, length);
  }
};

std::string ErrorsByFrame(const Comparison& comparison) {
  std::string text =
      "recording,frame,time_s,fitted,points,rms_m,rms_over_sigma,largest_m,mean_difference_x_m,"
      "mean_difference_y_m,mean_difference_z_m\n";
  for (size_t r = 0; r < comparison.residuals.size(); ++r) {
    const RecordedResiduals& residuals = comparison.residuals[r];
    const ComparedRecording& recording = comparison.record.recordings[r];
    const Eigen::MatrixXd lengths = PointLengths(residuals.difference);
    const Eigen::MatrixXd over_noise = LengthsOverNoise(residuals, recording);
    for (int f = 0; f < static_cast<int>(residuals.frames.size()); ++f) {
      KnownLengths known;
      for (const double length : lengths.col(f)) known.Add(length);
      const Eigen::Vector3d mean = MeanOver(residuals.difference, f, f).mean;
      text += fmt::format("{},{},{},{:d},{},{},{},{},{},{},{}\n", r, residuals.frames[f],
                          residuals.times[f], residuals.fitted[f] != 0, known.count,
                          Rms(lengths.col(f)), Rms(over_noise.col(f)), known.largest, mean[0],
                          mean[1], mean[2]);
    }
  }
  return text;
}

std::string ErrorsByMarker(const Comparison& comparison) {
  std::string text =
      "recording,marker,fitted,frames,rms_m,rms_over_sigma,largest_m,mean_difference_x_m,"
      "mean_difference_y_m,mean_difference_z_m,mean_place_x_m,mean_place_y_m,mean_place_z_m\n";
  for (size_t r = 0; r < comparison.residuals.size(); ++r) {
    const RecordedResiduals& residuals = comparison.residuals[r];
    const ComparedRecording& recording = comparison.record.recordings[r];
    const Eigen::MatrixXd lengths = PointLengths(residuals.difference);
    const Eigen::MatrixXd over_noise = LengthsOverNoise(residuals, recording);
    const Eigen::Matrix3Xd places = MeanPlaces(residuals);
    const std::vector<FrameRange> ranges = FittedAndHeldOutRanges(residuals);
    for (size_t p = 0; p < ranges.size(); ++p) {
      const FrameRange& range = ranges[p];
      for (Eigen::Index m = 0; m < lengths.rows(); ++m) {
        KnownLengths known;
        for (const double length : lengths.row(m).segment(range.first, range.Count()))
          known.Add(length);
        const double rms = recording.parts[p].point_rms[m];
        const double multiple = Rms(over_noise.row(m).segment(range.first, range.Count()));
        const Eigen::Vector3d mean =
            MeanOver(residuals.difference.middleRows<3>(3 * m), range.first, range.last).mean;
        text += fmt::format("{},{},{:d},{},{},{},{},{},{},{},{},{},{}\n", r, m, range.fitted,
                            known.count, rms, multiple, known.largest, mean[0], mean[1], mean[2],
                            places(0, m), places(1, m), places(2, m));
      }
    }
  }
  return text;
}

std::string ErrorsByQuantity(const ComparisonRecord& record) {
  std::string text = "recording,fitted,quantity,low,high,mean,count,rms_m,rms_over_sigma\n";
  for (size_t r = 0; r < record.recordings.size(); ++r) {
    const ComparedRecording& recording = record.recordings[r];
    for (const ComparedPart& part : recording.parts)
      for (const ErrorTrend& trend : part.trends)
        for (const ErrorBin& bin : trend.bins)
          text += fmt::format("{},{:d},{},{},{},{},{},{},{}\n", r, part.fitted, trend.quantity,
                              bin.low, bin.high, bin.mean, bin.count, bin.rms, bin.rms_over_sigma);
  }
  return text;
}

constexpr const char* kForceTableHeader =
    "recording,time_s,force_x_N,force_y_N,force_z_N,force_deviation_x_N,force_deviation_y_N,"
    "force_deviation_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,torque_deviation_x_Nm,"
    "torque_deviation_y_Nm,torque_deviation_z_Nm,power_W,place_x_m,place_y_m,place_z_m\n";

std::string ForceTableRows(const ForceHistory& history, size_t recording) {
  std::string text;
  for (Eigen::Index k = 0; k < history.times.size(); ++k) {
    text += fmt::format("{},{}", recording, history.times[k]);
    for (const Eigen::Matrix3Xd* rows :
         {&history.force, &history.force_deviation, &history.torque, &history.torque_deviation})
      for (int axis = 0; axis < 3; ++axis) text += fmt::format(",{}", (*rows)(axis, k));
    text += fmt::format(",{}", history.power[k]);
    for (int axis = 0; axis < 3; ++axis) text += fmt::format(",{}", history.centroid(axis, k));
    text += "\n";
  }
  return text;
}

}  // namespace

void WriteComparison(const Comparison& comparison, const std::filesystem::path& run) {
  const std::filesystem::path folder = run / "comparison";
  MakeFolder(folder);
  WriteFileAtomically(folder / "by_frame.csv", ErrorsByFrame(comparison));
  WriteFileAtomically(folder / "by_marker.csv", ErrorsByMarker(comparison));
  WriteFileAtomically(folder / "by_quantity.csv", ErrorsByQuantity(comparison.record));
  std::string forces;
  for (size_t r = 0; r < comparison.forces.size(); ++r) {
    const std::optional<UnexplainedForce>& force = comparison.forces[r];
    if (force && force->record.usable) forces += ForceTableRows(force->history, r);
  }
  const std::filesystem::path force_file = folder / "unexplained_force.csv";
  if (forces.empty()) {
    std::filesystem::remove(force_file);  // may be left from an earlier comparison
  } else {
    WriteFileAtomically(force_file, kForceTableHeader + forces);
  }
  WriteComparisonFile(comparison.record, DescribeComparison(comparison.record),
                      folder / "comparison.json");
}

}  // namespace lacuna
