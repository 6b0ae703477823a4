#include "plan/protocol_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/file_name.h"
#include "core/quantity.h"
#include "core/suggestion.h"

namespace lacuna {
namespace {

// The largest factor on the duration and on the pull: beyond it a slip of the keyboard is likelier.
constexpr double kLargestFactor = 100;
constexpr int kMostMarkers = 1000;

const PredictedRecording& ReadBase(const Config& item, const PredictionStudy& study) {
  if (!item.Has("recording")) return PlannableRecording(study);
  const std::string name = item.Text("recording");
  std::vector<std::string> known;
  for (const PredictedRecording& recording : study.recordings) {
    if (recording.name != name) {
      known.push_back(recording.name);
    } else if (recording.ShowsScans()) {
      item.Fail("recording", "shows scans; only recordings of markers can be planned yet");
    } else {
      return recording;
    }
  }
  item.Fail("recording", fmt::format("the run has no recording \"{}\"{}; its recordings: {}", name,
                                     Suggestion(name, known), fmt::join(known, ", ")));
}

Eigen::Vector3d ReadTurn(const Config& turn) {
  const Eigen::Vector3d axis = turn.Vector("axis", kDimensionless);
  if (axis.norm() == 0) turn.Fail("axis", "expected a direction other than 0");
  constexpr double kHalf = (1 + 1e-12) * std::numbers::pi;  // 180 deg may be rounded
  const double angle = turn.Quantity("angle", kAngle, kAnyValue);
  if (std::abs(angle) > kHalf)
    turn.Fail("angle", fmt::format("got {:.6g} deg; expected an angle from -180 deg to 180 deg",
                                   angle * 180 / std::numbers::pi));
  return angle * axis.normalized();
}

Protocol::Shake ReadShake(const Config& shake, const PredictedRecording& base, double time_step) {
  Protocol::Shake read;
  read.amplitude = shake.Vector("amplitude", kLength);
  if (read.amplitude.norm() == 0) shake.Fail("amplitude", "expected a displacement other than 0");
  read.frequency = shake.Quantity("frequency", kRate, kPositive);
  const double highest = HighestShakeFrequency(base, time_step);
  if (read.frequency > highest)
    shake.Fail("frequency",
               fmt::format("at most {:.3g} Hz can be resolved: a period needs at least {:g} time "
                           "steps, of {} here, and {:g} frames of \"{}\"",
                           highest, kStepsPerPeriod, DurationText(time_step), kFramesPerPeriod,
                           base.name));
  return read;
}

Protocol ReadProtocol(const Config& item, const PredictionStudy& study) {
  const Bounds factor{0, kLargestFactor, true, false};
  Protocol protocol;
  protocol.name = item.Text("name");
  if (protocol.name.empty()) item.Fail("name", "is empty");
  const PredictedRecording& base = ReadBase(item, study);
  protocol.recording = base.name;
  protocol.duration = item.Number("duration", factor, protocol.duration);
  protocol.pull = item.Number("pull", factor, protocol.pull);
  if (const auto turn = item.OptionalChild("turn")) protocol.turn = ReadTurn(*turn);
  if (const auto shake = item.OptionalChild("shake"))
    protocol.shake = ReadShake(*shake, base, study.time_step);
  if (const auto weight = item.OptionalChild("weight"))
    protocol.weight = Protocol::Weight{weight->Quantity("mass", kMass, kPositive),
                                       weight->Vector("place", kLength),
                                       weight->Quantity("radius", kLength, kPositive)};
  protocol.more_markers = item.Integer("more_markers", 0, kMostMarkers, 0);
  return protocol;
}

}  // namespace

ProtocolFile ReadProtocols(const Config& config, const PredictionStudy& study) {
  config.Integer("schema_version", 1, 1);
  ProtocolFile file;
  file.stock = config.Flag("stock", file.stock);
  file.items = config.Items("protocols");
  if (!config.Has("protocols"))
    config.Fail("protocols", "is absent; expected a list like [{name: harder, pull: 2}]");
  if (file.items.empty()) config.Fail("protocols", "is empty");
  for (const Config& item : file.items) {
    Protocol protocol = ReadProtocol(item, study);
    for (const Protocol& other : file.protocols) {
      if (other.name == protocol.name)
        item.Fail("name",
                  fmt::format("\"{}\" is already the name of another protocol", protocol.name));
      if (FileNameFor(other.name) == FileNameFor(protocol.name))
        item.Fail("name", fmt::format("\"{}\" would have the same folder, {}, as \"{}\"",
                                      protocol.name, FileNameFor(protocol.name), other.name));
    }
    file.protocols.push_back(std::move(protocol));
  }
  config.RefuseUnknownKeys();
  return file;
}

}  // namespace lacuna
