#include "scan/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "core/atomic_file.h"
#include "core/quoted_text.h"
#include "scan/marker_frames.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

std::string AsComment(const std::string& text) {
  std::string comment;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    comment += "# " + text.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return comment;
}

}  // namespace

bool IsSimulatedRecording(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "recording.yaml");
  std::string line;
  return std::getline(stream, line) && line == std::string("# ") + kSimulated;
}

void MarkAsSimulated(const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "recording.yaml", AsComment(kSimulated));
}

std::string WriteDensityAndGravity(const RecordedObject& object) {
  std::string yaml;
  if (object.density) yaml += fmt::format("density: {} kg/m^3\n", *object.density);
  if (object.gravity) yaml += fmt::format("gravity: {}\n", FormatVector(*object.gravity, "m/s^2"));
  return yaml;
}

std::string WriteConstraints(const std::filesystem::path& folder, const RecordedObject& object) {
  std::string yaml;
  const auto held = [&](std::string item, size_t part) {
    for (size_t i = 0; i < object.reactions.size(); ++i) {
      if (object.reactions[i].held != part) continue;
      item.pop_back();
      item += ", " + WriteReaction(folder, object.reactions[i], i + 1) + "}";
    }
    return "  - " + item + "\n";
  };
  if (!object.fixed.empty()) yaml += "fixed:\n";
  for (size_t i = 0; i < object.fixed.size(); ++i) yaml += held(WriteSupport(object.fixed[i]), i);
  if (!object.grips.empty()) yaml += "gripped:\n";
  for (size_t i = 0; i < object.grips.size(); ++i)
    yaml += held(WriteGrip(folder, object.grips[i], i + 1), object.fixed.size() + i);
  if (!object.forces.empty()) yaml += "forces:\n";
  for (size_t i = 0; i < object.forces.size(); ++i) {
    yaml += "  - " + WriteForce(folder, object.forces[i], i + 1) + "\n";
  }
  return yaml;
}

void WriteMarkerRecording(const std::filesystem::path& folder, const MarkerRecording& recording) {
  MakeFolder(folder);
  const std::filesystem::path reference =
      std::filesystem::absolute(recording.reference)
          .lexically_normal()
          .lexically_proximate(std::filesystem::absolute(folder).lexically_normal());
  std::string yaml = AsComment(recording.comment);
  yaml += fmt::format("schema_version: 1\nname: {}\nlength_unit: m\n", QuotedText(recording.name));
  yaml += WriteDensityAndGravity(recording.object);
  yaml += "frames:\n" + WriteMarkerFrames(folder, recording.times, recording.markers);
  if (recording.instrument.subset > 0)
    yaml += fmt::format("instrument: {{subset: {} m, shape: {}}}\n", recording.instrument.subset,
                        recording.instrument.is_volume ? "volume" : "surface");
  yaml += WriteConstraints(folder, recording.object);
  yaml += fmt::format("reference: {{from: tet_mesh, file: \"{}\"}}\n", reference.generic_string());
  WriteFileAtomically(folder / "recording.yaml", yaml);
}

}  // namespace lacuna
