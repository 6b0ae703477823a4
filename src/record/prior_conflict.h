// Conflicts between a fit and its priors, as plain data.
//
// A conflict is an estimate several standard deviations away from its prior mean. The cause may be
// a mistake in the measurement, or physics that the model lacks.
#ifndef LACUNA_RECORD_PRIOR_CONFLICT_H_
#define LACUNA_RECORD_PRIOR_CONFLICT_H_

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

namespace lacuna {

// A nuisance parameter of a recording (its clock, a grip's offset) is far from 0.
struct NuisanceParameterConflict {
  std::string parameter;
  double deviations = 0;  // distance in standard deviations of its prior
};

// An estimated parameter of the model is far from the mean of its prior.
struct ModelParameterConflict {
  std::string parameter, unit;
  // Distance in standard deviations of the prior, on the scale on which the parameter is fitted.
  double deviations = 0;
  double mean = 0;          // SI, of the prior
  bool is_default = false;  // nobody has given the prior: it is that of the effect's card
};

// A marker's estimated place on the undeformed object is far from the recorded one.
struct MarkerConflict {
  std::string recording, marker;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, estimated − recorded
  double deviation = 0;                              // m, of the prior (place_deviation)
};

// The number of a recording's markers in conflict, where only the worst are listed.
struct MarkerConflictCount {
  std::string recording;
  int conflicting = 0, markers = 0;
};

// Tracked points in the frame that shows the undeformed object do not lie on the given shape.
struct ReferenceShapeConflict {
  std::string recording;
  int frame = 0;
  double rms = 0;        // m, distance of the points from the shape
  double deviation = 0;  // m, of the prior (place_deviation)
};

// Patches of a scanned surface are offset from the model's surface by the same distance in all
// frames.
struct PatchConflict {
  std::string recording;
  int conflicting = 0, patches = 0;
  double largest = 0;    // m
  double deviation = 0;  // m, of the prior (scan.shape_deviation)
};

// In some frames, much of the scan is farther from the predicted surface than scan.reach, and was
// not compared.
struct UnmatchedScans {
  std::string recording;
  int unmatched = 0, frames = 0;
  double first_time = 0;   // s, time of the first of these frames
  double least_share = 0;  // fewer points than this share of the best frame's were compared
};

using PriorConflict =
    std::variant<NuisanceParameterConflict, ModelParameterConflict, MarkerConflict,
                 MarkerConflictCount, ReferenceShapeConflict, PatchConflict, UnmatchedScans>;

nlohmann::json PriorConflictToJson(const PriorConflict& conflict);
// Throws nlohmann::json::exception and InputError.
PriorConflict PriorConflictFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_PRIOR_CONFLICT_H_
