// Summary of the body force that would have made a fitted model follow a recording, as it is stored
// in comparison.json. It is estimated by comparison/force_estimate.h.
//
// Vectors are x, y, z in the model's frame. Every ± value is one standard deviation.
#ifndef LACUNA_RECORD_UNEXPLAINED_FORCE_RECORD_H_
#define LACUNA_RECORD_UNEXPLAINED_FORCE_RECORD_H_

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lacuna {

// The net force, N, summarised over the time of the motion.
struct NetForceSummary {
  Eigen::Vector3d rms = Eigen::Vector3d::Zero(), rms_deviation = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), mean_deviation = Eigen::Vector3d::Zero();
  double constant_share = 0;  // |mean| / |rms|: 1 for a force that never changes
  double weight = 0;          // weight of the part that no grip holds, as a reference
};

// The work of the force on the motion that includes it. Positive work adds energy to the motion.
struct ForceWork {
  double duration = 0;             // s
  double work = 0, deviation = 0;  // J
  double mean_power = 0;           // W
};

// The place on the undeformed object where the force acts, averaged over time.
struct ForcePlace {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // m, of the density's magnitude
  double grip_distance = 0;          // m, centroid to nearest gripped node; 0: no grip
  double largest_grip_distance = 0;  // m, largest for any node; 0: no grip
};

// Correlation of the net force with the motion of the centre of mass, over all components and
// times, each component about its mean. From −1 to 1.
struct ForceCorrelation {
  std::string quantity;  // "displacement", "velocity" or "acceleration"
  double correlation = 0;
};

// How well the force explains the residual, and how the search for it ended.
struct ForceFitSummary {
  // Rms of the whitened residual of the model without and with the force.
  double rms_over_sigma_without = 0, rms_over_sigma_with = 0;
  double log_evidence = 0;  // ln of the likelihood ratio of a force to none, to first order
  double noise_scale = 1;   // remaining residual over the noise; all deviations include it
  int knots = 0;            // number of knots of the force in time
  double knot_spacing = 0;  // s
  int predictions = 0;      // number of predictions in the search
  bool converged = false;   // the nonlinear model confirmed the last linear prediction
  // The evidence favours a force, and a component or its mean exceeds two of its deviations or the
  // work exceeds three.
  bool is_significant = false;
};

struct UnexplainedForceRecord {
  bool usable = false;
  std::string message;  // why it is not usable
  NetForceSummary net;
  ForceWork work;
  ForcePlace place;
  std::vector<ForceCorrelation> correlations;
  ForceFitSummary fit;
};

nlohmann::json UnexplainedForceToJson(const UnexplainedForceRecord& record);
// Throws nlohmann::json::exception when a key is absent or of another type.
UnexplainedForceRecord UnexplainedForceFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_UNEXPLAINED_FORCE_RECORD_H_
