// A protocol: how the next recording of the same object would be made, as changes to one of the
// recordings that are there. Without any change it is that recording once more.
#ifndef LACUNA_PLAN_PROTOCOL_H_
#define LACUNA_PLAN_PROTOCOL_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

struct Protocol {
  std::string name;       // in tables and, with other characters replaced by _, in file names
  std::string recording;  // the name of the recording that is changed
  // Factor on the time after the release; what moves the grips rests in its last pose then.
  double duration = 1;
  // Factor on the force that holds the object before its release; where nothing holds it, on the
  // known forces; where there are none, on the given paths of the grips.
  double pull = 1;
  // The whole fixture, grips and holding hand, is rotated about the middle of the first grip before
  // the recording: a rotation vector, rad. Gravity and the known forces keep their directions.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  // All grips move by amplitude · sin²(π f (t − t₀)) from the release t₀ on.
  struct Shake {
    Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();  // m
    double frequency = 0;                                 // f, 1/s
  };
  std::optional<Shake> shake = {};
  // A known mass is fixed to the object.
  struct Weight {
    double mass = 0;                                  // kg
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, on the undeformed object
    double radius = 0;  // m, standard deviation of its distribution about the place
  };
  std::optional<Weight> weight = {};
  int more_markers = 0;  // further markers, evenly over the free surface
};

// The highest frequency, 1/s, at which a clamp may be shaken in variants of a recording that are
// simulated with the time step `time_step`, s. A period of the motion needs at least
// kStepsPerPeriod steps, fewer of which would not follow its path, and kFramesPerPeriod frames,
// fewer of which would show a slower motion (the sampling theorem).
inline constexpr double kStepsPerPeriod = 6, kFramesPerPeriod = 2;
double HighestShakeFrequency(const PredictedRecording& item, double time_step);

// What is done, in words: `"bar" with 2 times the pull, clamp turned by 90° about y`.
std::string DescribeProtocol(const Protocol& protocol);

// The recording from which plans start unless a protocol names another: the first one that is
// fitted and has markers. Throws InputError, naming the experiment's file, where there is none:
// recordings of scans cannot be planned.
const PredictedRecording& PlannableRecording(const PredictionStudy& study);

// The variants of that recording that suit it: there is no clamp to turn where none is, nor a pull
// to double where nothing pulls.
std::vector<Protocol> StockProtocols(const PredictionStudy& study, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PROTOCOL_H_
