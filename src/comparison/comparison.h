// How far a fitted model is from what was measured: where, when, in which direction, and whether
// what is left is noise. Read from the run. Where its experiment and recordings are still as they
// were, markers go by their names and the error is told against the distance from the grip too.
#ifndef LACUNA_COMPARISON_COMPARISON_H_
#define LACUNA_COMPARISON_COMPARISON_H_

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/residual_statistics.h"
#include "analysis/whiteness.h"
#include "comparison/unexplained_force.h"
#include "core/progress.h"

namespace lacuna {

inline constexpr double kBeyondNoise = 1.5;  // an error this many times that of noise is none

// The error against one quantity: of frames, rms over their markers both, against time,
// displacement and speed, and, where the model was run again, strain, its rate (these rms over the
// markers) and height (their mean); of markers, rms over the frames, against their distance from
// the grip.
struct ErrorAgainst {
  std::string quantity;  // with its unit: "speed_m_per_s"
  std::vector<ResidualBin> bins;
  double rank_correlation = kUnknown;
};

// The frames of one recording that were fitted, or those that were held out. Lengths are of the
// difference predicted − measured, m.
struct ComparedPart {
  bool fitted = true;
  int first = 0, last = 0;  // columns of the recording's frames
  int points = 0;           // markers seen, over all frames
  double rms = kUnknown, largest = kUnknown;
  int largest_marker = -1;  // where, and when: its column
  int largest_column = -1;
  double in_noise = kUnknown;  // rms over √3 σ, σ the noise that the fit weighed with
  double in_floor = kUnknown;  // rms over √3 times the recording's own floor
  // m, rms of what is the same in all frames (of each marker, its mean error), and of the rest.
  double steady = kUnknown, changing = kUnknown;
  TimeWhiteness in_time;
  double correlation_time = kUnknown;  // s
  SpaceWhiteness in_space;
  Eigen::VectorXd of_markers;  // rms of each, m
  int worst_marker = -1;
  // The longest run of frames, three at least, worse than the whole part's rms and than
  // kBeyondNoise; a twentieth of the frames may lie between two of them.
  FrameSpan worst_span;
  double worst_span_rms = kUnknown;
  MeanVector worst_span_error;  // of all markers there
  MeanVector mean_error;        // of the whole part
  std::vector<ErrorAgainst> against;
};

struct ComparedRecording {
  std::string name;
  // Of scans the points are patches of the surface, measured along its normal only.
  bool is_scan = false;
  double noise = 0;                  // m, σ of a component of a point that the fit weighed with
  std::vector<int> frames;           // of the recording
  Eigen::VectorXd times;             // s
  std::vector<char> fitted;          // per frame
  Eigen::MatrixXd measured;          // 3 markers × frames, m
  Eigen::MatrixXd difference;        // predicted − measured, m
  Eigen::Matrix3Xd mean_places;      // of each marker as measured, over all frames, m
  std::vector<std::string> markers;  // names; their numbers where the recording is not there
  Eigen::VectorXd grip_distance;     // of each marker's place on the object, m; empty: not known
  double white_noise = kUnknown;     // m, of a measured coordinate, from its second differences
  std::vector<StaticSpan> rests;
  double rest_deviation = kUnknown;  // m, the median of the spans'
  double floor = kUnknown;           // m: the larger of the two
  std::vector<ComparedPart> parts;   // fitted first; one where nothing was held out
  // Where the model was run again (CompareMotion).
  std::optional<UnexplainedForce> force;
  bool height_by_gravity = false;  // else z
  int field_frames = 0;            // written as VTU and VTP

  // The rms length, m, of errors that are noise of σ alone: √3 σ of a marker, σ of a patch.
  double LengthOf(double sigma) const { return (is_scan ? 1 : std::sqrt(3.0)) * sigma; }
  const char* PointName() const { return is_scan ? "patch" : "marker"; }
};

// Two recordings of the same rate, as they were measured.
struct ComparedPair {
  std::string first, second;
  Repeatability repeatability;
};

struct Comparison {
  double noise = 0;  // m, σ of a coordinate that the fit weighed with
  std::vector<ComparedRecording> recordings;
  std::vector<ComparedPair> pairs;
  std::vector<std::string> notes;  // what could not be told, and why
};

// Throws InputError when the folder is no finished run of `lacuna fit`, or its files are damaged.
Comparison CompareRun(const std::filesystem::path& run);

// Runs the fitted model again: adds the error against strain, strain rate and height, and the
// unexplained force, and writes fields as VTU and VTP to <run>/comparison/<number of the
// recording>. Where the run's experiment or recordings are not as they were, a note says so
// instead. Throws InputError when files cannot be written, and Interrupted.
void CompareMotion(const std::filesystem::path& run, Progress* progress, Comparison* comparison);

// What it says, one paragraph of sentences a recording and part.
std::vector<std::string> ComparisonInWords(const Comparison& comparison);

// <run>/comparison/: comparison.json (written last), by_frame.csv, by_marker.csv, against.csv,
// unexplained_force.csv where there is one; each whole or not there. Throws InputError when they
// cannot be written.
void SaveComparison(const Comparison& comparison, const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARISON_H_
