// Writes the measurements of virtual cameras that observe a moving surface as a recording folder.
#ifndef LACUNA_SCAN_SCAN_WRITER_H_
#define LACUNA_SCAN_SCAN_WRITER_H_

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"
#include "scan/depth_frames.h"
#include "scan/point_frames.h"
#include "scan/recorded_object.h"
#include "scan/virtual_scanner.h"

namespace lacuna {

// Writes the frames of one kind into a recording folder and returns the entries of `frames:` in its
// recording.yaml, each line indented by two spaces. WritePointFrames and WriteDepthFrames are such
// writers.
using FrameWriter = std::string (*)(const std::filesystem::path& folder, const VirtualScan& scan);

// Writes `folder`: recording.yaml, the frames that `write_frames` makes of the scan, and truth/
// with the exact surfaces, which recording.yaml does not mention. Grips of `object` follow the scan
// or a given path. recording.yaml is marked as simulated (recording_writer.h). It is written last,
// so that an unfinished folder is not a recording. Throws InputError when the folder cannot be
// written and when `write_frames` does.
void WriteScan(const std::filesystem::path& folder, const std::string& name,
               const RecordedObject& object, const VirtualScan& scan, FrameWriter write_frames);

// The exact surface behind frame i of such a folder. Only for judging results. Throws InputError
// where a file cannot be read or is not such an array.
TriMesh ReadTrueSurface(const std::filesystem::path& folder, int i);
// The files that it reads for these frames, each once.
std::vector<std::filesystem::path> FilesOfTrueSurfaces(const std::filesystem::path& folder,
                                                       const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_SCAN_SCAN_WRITER_H_
