// The text tables that motion-capture programs write: TSV of Qualisys Track Manager, CSV of
// OptiTrack Motive and of DeepLabCut. All have a header of their own above the rows.
#ifndef LACUNA_SCAN_CAPTURE_TABLES_H_
#define LACUNA_SCAN_CAPTURE_TABLES_H_

#include <filesystem>

#include "scan/marker_tracks.h"

namespace lacuna {

enum class CaptureTable { kNone, kQualisys, kMotive, kDeepLabCut };

// What the first line of a text file says it is: "NO_OF_FRAMES" or "FILE_VERSION" begin a table of
// Qualisys, "Format Version" one of Motive, "scorer" one of DeepLabCut. Throws InputError when the
// file cannot be read.
CaptureTable CaptureTableOf(const std::filesystem::path& file);

// 3-D data with MARKER_NAMES; lengths are in mm. Rows may begin with the frame and the time;
// without a time, that of frame i is i/FREQUENCY. A marker was not seen where its entries are
// empty, "NULL" or all zero. Throws InputError naming file and line when the header is incomplete,
// a row does not fit it, there is no row, or times that are used do not ascend.
MarkerTracks ReadQualisysTsv(const std::filesystem::path& file, FileTimes use);

// The measured positions, i.e. the columns of the type "Marker"; those that a solver has computed
// for rigid bodies and bones are left out. Names that repeat are numbered. Lengths are in the unit
// of the first line. Throws InputError likewise.
MarkerTracks ReadMotiveCsv(const std::filesystem::path& file, FileTimes use);

// Points that DeepLabCut has triangulated: the rows scorer, perhaps individuals, bodyparts and
// coords above the columns. Names are those of the body parts, behind "individual " where there are
// individuals. The file has no times. Throws InputError where it has x and y only, which are pixels
// of one camera.
MarkerTracks ReadDeepLabCutCsv(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_CAPTURE_TABLES_H_
