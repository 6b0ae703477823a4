// Writes descriptions of recordings: what is held and loaded, and whole recordings of markers.
#ifndef LACUNA_SCAN_RECORDING_WRITER_H_
#define LACUNA_SCAN_RECORDING_WRITER_H_

#include <filesystem>
#include <string>
#include <vector>

#include "scan/instrument.h"
#include "scan/marker_tracks.h"
#include "scan/recorded_object.h"

namespace lacuna {

// The entries `density`, `gravity`, `fixed`, `gripped` and `forces` of a recording.yaml in `folder`
// whose data are there. Paths, forces and reactions go into files of the folder. Throws InputError
// when one cannot be written.
std::string WriteDensityAndGravity(const RecordedObject& object);
std::string WriteConstraints(const std::filesystem::path& folder, const RecordedObject& object);

// The first line of recording.yaml, as a comment, where a simulation has written the recording.
inline constexpr char kSimulated[] =
    "Simulated by Lacuna; another simulation may replace the files of this folder.";
// Whether `folder` contains a recording.yaml whose first line is this comment.
bool IsSimulatedRecording(const std::filesystem::path& folder);
// Writes a recording.yaml that contains nothing but this comment, in place of any that is there, so
// that a folder whose recording is not complete can be recognised. Throws InputError when it cannot
// be written.
void MarkAsSimulated(const std::filesystem::path& folder);

// A recording of markers that were simulated.
struct MarkerRecording {
  std::string name;
  RecordedObject object;
  std::vector<double> times;  // s, one per frame
  Markers markers;            // their weights are not written: a file of markers has none
  Instrument instrument;
  std::filesystem::path reference;  // a file of tetrahedra, m, in the world frame
  std::string comment;              // for people: the first lines of recording.yaml
};

// Writes `folder`: markers.csv, the files of its grips and loads, and then recording.yaml, which
// refers to the reference by its path relative to the folder. Throws InputError when a file cannot
// be written.
void WriteMarkerRecording(const std::filesystem::path& folder, const MarkerRecording& recording);

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDING_WRITER_H_
