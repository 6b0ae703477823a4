#include "reconstruction/recorded_states.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <regex>

#include "core/interrupt.h"

namespace lacuna {
namespace {

// A note without its numbers.
std::string KindOfNote(const std::string& note) {
  static const std::regex number("[-+]?[0-9.]+(e[-+]?[0-9]+)?");
  return std::regex_replace(note, number, "");
}

// Replaces the columns of `places` by those of `given` that are known.
void ReplaceKnown(const Eigen::Matrix3Xd& given, Eigen::Matrix3Xd* places) {
  CHECK_EQ(given.cols(), places->cols());
  for (Eigen::Index j = 0; j < given.cols(); ++j)
    if (given.col(j).allFinite()) places->col(j) = given.col(j);
}

// The notes of one kind.
struct NotesOfKind {
  std::string kind, first;  // the kind, and the first note of it
  std::vector<int> frames;  // that have such a note, each once
};

// Which frames have a note of the kind, too, after the first of them; empty where there are none.
std::string OtherFrames(const std::vector<int>& frames) {
  const size_t others = frames.size() - 1;
  if (others == 0) return "";
  if (others == 1) return fmt::format("; so has frame {}", frames.back());
  return fmt::format("; {} other frames have such a note, up to frame {}", others, frames.back());
}

}  // namespace

std::vector<FrameState> LoadFrameStates(const ReconstructionStudy& study, Progress* progress) {
  const FrameStateOptions options{study.filter, study.surface, study.surfaces_of_frames,
                                  study.validation.hold_out_every};
  std::vector<FrameState> states;
  progress->Begin("surfaces", static_cast<int64_t>(study.frames.size()));
  for (const int frame : study.frames) {
    ThrowIfInterrupted();
    states.push_back(MakeFrameState(study.recording, frame, options));
    progress->Report(static_cast<int64_t>(states.size()));
  }
  progress->End();
  return states;
}

ReferenceBody MakeReferenceBody(const ReconstructionStudy& study, const FrameState& first) {
  return MakeReferenceBody({study.name, study.recording, study.mesh, study.sheet_layers,
                            study.frames.front(), &first.surface});
}

bool FirstFrameIsReference(const ReconstructionStudy& study) {
  return study.recording.reference.source == ReferenceSource::kFirstFrame;
}

bool HasIdentifiedPoints(const ReconstructionStudy& study, const std::vector<FrameState>& states) {
  return study.follow.use_identity && states.front().tracked.cols() > 0;
}

PlacesAtRest FindPlacesAtRest(const ReconstructionStudy& study,
                              const std::vector<FrameState>& states) {
  PlacesAtRest places{states.front().tracked, states.front().held_out};
  const Eigen::Matrix3Xd& given = study.recording.markers.places;
  if (given.cols() == 0) return places;
  const TrackedRows rows =
      SplitRows(study.recording, given.cols(), study.validation.hold_out_every);
  ReplaceKnown(given(Eigen::all, rows.used), &places.tracked);
  ReplaceKnown(given(Eigen::all, rows.held_out), &places.held_out);
  return places;
}

std::vector<std::string> WarningsOfStates(const ReconstructionStudy& study,
                                          const std::vector<FrameState>& states) {
  const std::vector<std::string>& told = study.recording.warnings;
  std::vector<NotesOfKind> kinds;
  for (size_t k = 0; k < states.size(); ++k)
    for (const std::string& note : states[k].notes) {
      if (std::find(told.begin(), told.end(), note) != told.end()) continue;
      const std::string kind = KindOfNote(note);
      auto found = std::find_if(kinds.begin(), kinds.end(),
                                [&](const NotesOfKind& other) { return other.kind == kind; });
      if (found == kinds.end()) found = kinds.insert(kinds.end(), {kind, note, {}});
      if (found->frames.empty() || found->frames.back() != study.frames[k])
        found->frames.push_back(study.frames[k]);
    }
  std::vector<std::string> warnings;
  for (const NotesOfKind& notes : kinds)
    warnings.push_back(fmt::format("frame {}: {}{}", notes.frames.front(), notes.first,
                                   OtherFrames(notes.frames)));
  return warnings;
}

}  // namespace lacuna
