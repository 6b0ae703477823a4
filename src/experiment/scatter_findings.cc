#include "experiment/scatter_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scan/recording_check.h"

namespace lacuna {
namespace {

// A stated noise within this factor of the scatter is not questioned: correlated errors and
// estimates from few frames differ by less. Smaller: more correct values are questioned.
constexpr double kStatedFactor = 3;
// A frame or a marker that scatters by this multiple of the typical one is unlike the others.
constexpr double kUnlikeOthers = 3;
// A cloud that scatters by more than this multiple of its spacing has no surface that a mesh could
// follow from point to point.
constexpr double kMeshable = 0.5;
// Normally distributed errors have no outliers, edges and silhouettes a few in a thousand points.
// The first is the share of all points, the second that of one frame.
constexpr double kManyOutliers = 0.005, kManyInFrame = 0.02;
constexpr double kNoScatter = 1e-9;  // m, rounding of the files

std::string InMillimetres(double length) { return fmt::format("{:.3g} mm", 1e3 * length); }

// "scan: {noise: 1 mm}" for the key scan.noise.
std::string AsYaml(const std::string& key, double length) {
  const size_t dot = key.find('.');
  if (dot == std::string::npos) return fmt::format("{}: {}", key, InMillimetres(length));
  return fmt::format("{}: {{{}: {}}}", key.substr(0, dot), key.substr(dot + 1),
                     InMillimetres(length));
}

std::string InPercent(double share) { return fmt::format("{:.2g} %", 100 * share); }

// "scatter by 0.2 mm (standard deviation)", at most so where more cannot be said.
std::string ScatterBy(const RecordingScatter& scatter) {
  if (scatter.typical < kNoScatter) return "do not scatter";
  return fmt::format("scatter by {}{} ({}, standard deviation)",
                     scatter.is_upper_bound ? "at most " : "", InMillimetres(scatter.typical),
                     scatter.is_of_surface
                         ? "along the normal of the surface through their neighbours"
                     : scatter.is_upper_bound ? "each coordinate about their motion"
                                              : "each coordinate while they rest");
}

void AddDoubtOfStated(const RecordingScatter& scatter, const StatedNoise& noise,
                      std::vector<std::string>* doubts) {
  if (!(noise.deviation > 0) || scatter.is_upper_bound ||
      scatter.typical <= kStatedFactor * noise.deviation)
    return;
  doubts->push_back(fmt::format(
      "the points {}, {:.2g} times the stated `{}`. The scatter is measured from the files; "
      "with the stated value, a fit would take noise for motion. Write `{}`, or omit the key "
      "to have the noise estimated",
      ScatterBy(scatter), scatter.typical / noise.deviation, AsYaml(noise.key, noise.deviation),
      AsYaml(noise.key, scatter.typical)));
}

// A note about a stated noise that is much larger than the scatter.
std::string NoteOfStated(const RecordingScatter& scatter, const StatedNoise& noise) {
  if (!(noise.deviation > kStatedFactor * scatter.typical)) return "";
  const std::string stated = AsYaml(noise.key, noise.deviation);
  if (scatter.typical < kNoScatter) return fmt::format("; the stated `{}` is used", stated);
  return fmt::format(
      "; the stated `{}` is {:.2g} times as large and is used; this is right if it includes "
      "errors that neighbouring points or frames have in common, or errors of the model",
      stated, noise.deviation / scatter.typical);
}

void AddDoubtOfSpacing(const RecordingScatter& scatter, double voxel,
                       std::vector<std::string>* doubts) {
  if (!(scatter.spacing > 0)) return;
  // The mean of the (v/s)² points of spacing s in a cube of width v scatters s/v times as much.
  const double mean_of = std::max(1.0, voxel / scatter.spacing);
  if (scatter.typical / mean_of <= kMeshable * scatter.spacing * mean_of) return;
  // With this width the means scatter by a quarter of it.
  const double enough = 2 * std::sqrt(scatter.typical * scatter.spacing);
  const std::string reason =
      voxel > 0 ? fmt::format("and means over a `voxel` of {} still by {}", InMillimetres(voxel),
                              InMillimetres(scatter.typical / mean_of))
                : "more than half of their spacing of " + InMillimetres(scatter.spacing);
  doubts->push_back(
      fmt::format("the points {}, {}: a surface through them cannot be meshed reliably. `voxel: "
                  "{}` under `filter` replaces them by means that scatter little",
                  ScatterBy(scatter), reason, InMillimetres(enough)));
}

// Doubts about outliers are raised for scans only: markers that leave their tracks for a frame may
// be exchanged, or the body was hit or let go there, which the description of the scatter mentions.
void AddDoubtOfOutliers(const RecordingScatter& scatter, std::vector<std::string>* doubts) {
  if (!scatter.is_of_surface ||
      (!(scatter.outlier_share > kManyOutliers) && !(scatter.worst_share > kManyInFrame)))
    return;
  doubts->push_back(fmt::format(
      "{} of the points are outliers, more than five standard deviations off the surface "
      "through their neighbours and up to {}; most in frame {}, {} of its points. `crop` under "
      "`frames` removes what lies beside the object; a smaller `outlier_deviations` under "
      "`filter` removes more of the rest",
      InPercent(scatter.outlier_share), InMillimetres(scatter.farthest), scatter.worst_frame,
      InPercent(scatter.worst_share)));
}

void AddDoubtOfLargest(const RecordingScatter& scatter, std::vector<std::string>* doubts) {
  // A marker that moves faster than the others, or while they rest, shows motion, not scatter.
  if (!scatter.is_of_surface || scatter.is_upper_bound || scatter.typical < kNoScatter ||
      scatter.largest <= kUnlikeOthers * scatter.typical)
    return;
  doubts->push_back(fmt::format("{} scatters by {}, {:.2g} times the typical {}",
                                scatter.largest_in, InMillimetres(scatter.largest),
                                scatter.largest / scatter.typical, InMillimetres(scatter.typical)));
}

}  // namespace

std::string DescribeScatter(const RecordingScatter& scatter, const StatedNoise& noise) {
  if (std::isnan(scatter.typical)) return "";
  std::string text = "the points " + ScatterBy(scatter);
  if (scatter.is_upper_bound)
    text += fmt::format(", including {} that the {} not resolve",
                        scatter.is_of_surface ? "shape" : "motion",
                        scatter.is_of_surface ? "points do" : "frames do");
  if (scatter.largest >= kNoScatter)
    text += fmt::format("; most {} {}, {}", scatter.is_of_surface ? "in" : "at", scatter.largest_in,
                        InMillimetres(scatter.largest));
  if (scatter.spacing > 0)
    text += fmt::format("; their spacing is {}", InMillimetres(scatter.spacing));
  if (!std::isnan(scatter.outlier_share))
    text += fmt::format("; {} {}", InPercent(scatter.outlier_share),
                        scatter.is_of_surface ? "are outliers" : "leave their track for a frame");
  if (scatter.worst_frame >= 0) {
    const std::string farthest = "up to " + InMillimetres(scatter.farthest);
    text += fmt::format(", {}, most in frame {}, {} of the {}",
                        scatter.is_of_surface ? farthest + " off the surface"
                                              : "by " + farthest + " in a coordinate",
                        scatter.worst_frame, InPercent(scatter.worst_share),
                        scatter.is_of_surface ? "points" : "tracks");
  }
  return text + NoteOfStated(scatter, noise);
}

std::vector<std::string> DoubtsOfScatter(const RecordingScatter& scatter,
                                         const StatedNoise& noise) {
  std::vector<std::string> doubts;
  if (std::isnan(scatter.typical)) return doubts;
  AddDoubtOfStated(scatter, noise, &doubts);
  AddDoubtOfSpacing(scatter, noise.voxel, &doubts);
  AddDoubtOfLargest(scatter, &doubts);
  AddDoubtOfOutliers(scatter, &doubts);
  return doubts;
}

ExaminedRecording ExamineRecording(const Recording& recording, const StatedNoise& noise,
                                   int64_t most_points) {
  ScatterSurvey survey(recording);
  ExaminedRecording examined;
  examined.findings =
      ExamineFrames(recording, most_points, [&](const Frame& frame) { survey.Add(frame); });
  const RecordingScatter scatter = survey.Result();
  for (std::string& doubt : DoubtsOfScatter(scatter, noise))
    examined.findings.push_back(std::move(doubt));
  examined.scatter = DescribeScatter(scatter, noise);
  return examined;
}

}  // namespace lacuna
