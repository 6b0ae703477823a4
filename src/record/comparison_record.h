// Plain data of a comparison: where, when and by how much the predictions of a fitted model differ
// from its recordings. It is stored in <run>/comparison/comparison.json.
//
// Everything that report/comparison_report.h prints is here, so that a stored comparison can be
// printed again without the model, its experiment or its recordings. An error is a length in m,
// predicted minus measured, of markers or of the patches of a scanned surface ("points"). A point
// is given by its index, a time in s on the recording's clock. NaN means that a value could not be
// determined from the data.
#ifndef LACUNA_RECORD_COMPARISON_RECORD_H_
#define LACUNA_RECORD_COMPARISON_RECORD_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/fitted_reaction.h"
#include "record/run_record.h"
#include "record/unexplained_force_record.h"

namespace lacuna {

// An rms error of at least this many times that of the noise counts as more than noise. Larger:
// fewer frames and recordings are reported as bad.
inline constexpr double kBeyondNoise = 1.5;

// The mean of error vectors, m, and how well their directions agree: |Σ e| / Σ |e|, 1 where all
// point the same way, near 0 where they cancel.
struct MeanDifference {
  Eigen::Vector3d mean = Eigen::Vector3d::Constant(kNotMeasured);
  double agreement = kNotMeasured;
};

// The size of the error over some frames. Lengths are in m.
struct ErrorSize {
  int points = 0;  // number of observed points, summed over the frames
  double rms = kNotMeasured;
  // rms of the lengths, each over that which noise alone gives the point in that frame: with the
  // fit's σ of the point, and with the recording's noise floor for a point with the σ `noise`.
  double rms_over_sigma = kNotMeasured, rms_over_floor = kNotMeasured;
  // rms² = steady² + changing²: each point's mean error over the frames, and the deviation from it.
  double steady = kNotMeasured, changing = kNotMeasured;
  double largest = kNotMeasured;
  int largest_point = -1;
  double largest_time = kNotMeasured;  // s
  MeanDifference mean_difference;
};

// Whether the error is white in time (Ljung & Box, Biometrika 65, 1978; analysis/whiteness.h).
struct TimeCorrelation {
  int lags = 0;                     // 0: too few frames; then all below is NaN
  double statistic = kNotMeasured;  // Ljung–Box Q
  double lag_one = kNotMeasured;    // correlation of neighbouring frames
  double time = kNotMeasured;       // s, correlation time; infinite: longer than the data
  double p_value = kNotMeasured;
};

struct PointCorrelation {
  int first = 0, second = 0;
  double distance = kNotMeasured;  // m
  double correlation = kNotMeasured;
};

// Whether the errors of different points are independent (analysis/whiteness.h).
struct SpaceCorrelation {
  double mean = kNotMeasured;    // mean over all pairs of points
  double length = kNotMeasured;  // m, correlation length; infinite: longer than the object
  double p_value = kNotMeasured;
  std::vector<PointCorrelation> pairs;  // left out for a scan, which has too many
};

// The longest period in which the error is above average and above noise.
struct WorstPeriod {
  int first_frame = 0, last_frame = 0;  // numbers of the recording's frames, both inclusive
  int frames = 0;                       // number of frames from first to last
  double from = 0, to = 0;              // s
  double rms = kNotMeasured;            // m
  MeanDifference mean_difference;
};

// One bin of an ErrorTrend.
struct ErrorBin {
  double low = 0, high = 0, mean = 0;    // in the unit of the quantity
  int count = 0;                         // number of frames, or of points for "grip_distance_m"
  double rms = 0;                        // m
  double rms_over_sigma = kNotMeasured;  // NaN: written by an earlier version
};

// The rms error of a frame (or of a point, for "grip_distance_m") as a function of one quantity.
struct ErrorTrend {
  std::string quantity;                    // name with unit: "speed_m_per_s"
  double rank_correlation = kNotMeasured;  // Spearman's coefficient
  std::vector<ErrorBin> bins;              // ascending, with about as many entries each
};

// The fitted frames of one recording, or its held-out frames.
struct ComparedPart {
  bool fitted = true;
  int frames = 0;
  double from = 0, to = 0;  // s, times of the first and last frame
  ErrorSize error;
  // m, the rms error with each point at the place on the object where it was measured. In `error`,
  // it is at the place that the fit gave it within the uncertainty of that measurement.
  double rms_at_measured_places = kNotMeasured;
  Eigen::VectorXd point_rms;  // m, for each point; NaN where it was never observed
  int worst_point = -1;       // point with the largest rms; −1: no point was observed
  TimeCorrelation in_time;
  SpaceCorrelation in_space;
  std::optional<WorstPeriod> worst_period;
  std::vector<ErrorTrend> trends;
};

// A period in which the object rests, and how its markers scatter there about a straight line.
struct RestPeriod {
  double from = 0, to = 0;            // s
  double deviation = kNotMeasured;    // m, scatter of a coordinate about the line
  double drift = kNotMeasured;        // m/s, rms slope of the line
  double noise_drift = kNotMeasured;  // m/s, the rms slope that uncorrelated noise alone gives
};

// The noise of a recording, estimated from the recording itself without a model. Values are
// standard deviations, m, of a coordinate of a marker or of a patch along its normal.
struct NoiseFloor {
  double floor = kNotMeasured;           // the larger of the next two
  double white = kNotMeasured;           // white part, from second differences
  double rest_deviation = kNotMeasured;  // median over the rest periods
  std::vector<RestPeriod> rests;
};

// Where the model's material is loaded most, at the nodes and in the states that were kept of the
// motion (fem/nodal_recovery.h). Places are on the undeformed object, m; times on the recording's
// clock, s.
struct LoadedMost {
  double von_mises = kNotMeasured, von_mises_time = kNotMeasured;  // Pa
  Eigen::Vector3d von_mises_place = Eigen::Vector3d::Constant(kNotMeasured);
  double stretch = kNotMeasured, stretch_time = kNotMeasured;  // the largest principal stretch
  Eigen::Vector3d stretch_place = Eigen::Vector3d::Constant(kNotMeasured);
};

struct ComparedRecording {
  std::string name;
  bool is_scan = false;  // its points are patches, measured along their normal
  double noise = 0;      // m, σ of a component of a typical point, as assumed in the fit
  std::vector<std::string> point_names;  // numbers if the recording is not available
  Eigen::VectorXd grip_distance;         // m, undeformed object; empty: unknown
  NoiseFloor noise_floor;
  std::vector<ComparedPart> parts;        // in chronological order: fitted, then held-out frames
  std::vector<FittedReaction> reactions;  // measured forces of the grips, as the fit predicts them
  // The following is known only if the model was run again.
  bool height_by_gravity = false;               // height is measured against gravity, else along z
  int field_frames = 0;                         // number of frames written for ParaView
  std::optional<LoadedMost> loaded_most;        // absent if not computed
  std::optional<UnexplainedForceRecord> force;  // absent if not computed

  // The rms length that noise of standard deviation σ per component would give: √3 σ for a marker,
  // σ for a patch.
  double RmsOfNoise(double sigma) const;
};

// A comparison of the measurements of two recordings with the same frame rate.
struct ComparedPair {
  std::string first, second;
  int frames = 0;  // frames of the first that the second covers
  // s, how much later the same motion is in the second, with the smallest distance.
  double delay = kNotMeasured;
  double distance = kNotMeasured;  // m, rms, without each marker's mean difference
};

struct ComparisonRecord {
  std::string fit;   // hash of the fit's calibration.json; empty: written by an earlier version
  double noise = 0;  // m, σ of a marker's coordinate assumed by the fit; 0: no markers
  std::vector<ComparedRecording> recordings;
  std::vector<ComparedPair> pairs;
  std::vector<std::string> notes;  // what could not be computed, and why
};

// Writes the record as JSON, atomically, together with its description in words.
// Throws InputError when the file cannot be written.
void WriteComparisonFile(const ComparisonRecord& record, const std::vector<std::string>& text,
                         const std::filesystem::path& file);

// Whether a comparison, of this format or another, belongs to the fit with this hash. True for a
// file that cannot be read, which ReadComparisonFile() refuses.
bool IsComparisonOf(const std::string& fit, const std::filesystem::path& file);

// Throws InputError when the file is absent, damaged or of another schema version.
ComparisonRecord ReadComparisonFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_COMPARISON_RECORD_H_
