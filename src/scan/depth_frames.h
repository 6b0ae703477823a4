// Frames of kind `depth`: 16-bit depth images of one or several synchronised cameras.
//
// Everything that depends on this kind is here: its data, its reader, what it writes and what
// `lacuna info` says about it. frame_source.h lists what each function has to do.
#ifndef LACUNA_SCAN_DEPTH_FRAMES_H_
#define LACUNA_SCAN_DEPTH_FRAMES_H_

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/camera_alignment.h"
#include "scan/data_location.h"
#include "scan/depth_image.h"
#include "scan/file_frames.h"
#include "scan/virtual_scanner.h"

namespace lacuna {

struct DepthFrames : FileFrames {
  static constexpr const char* kKind = "depth";
  static constexpr const char* kTitle = "depth images";

  double depth_unit = 0;                                       // m per count of the images
  double min_depth = 0;                                        // m; smaller depths are dropped
  double max_depth = std::numeric_limits<double>::infinity();  // m; larger depths are dropped
  bool poses_are_inverse = false;             // given as camera_from_world (the first camera's)
  std::vector<Camera> cameras;                // poses are replaced by refined ones, if any
  std::optional<AlignmentOptions> alignment;  // options of the refinement; none: poses are kept
  std::vector<CameraCorrection> corrections;  // change of each pose; empty before refinement
};

void ReadSource(const Config& frames, const DataLocation& data, DepthFrames* source,
                std::vector<std::string>* warnings);
// The points of all cameras, one camera after the other; `sensors.seen_by` says which camera saw
// each point. Throws InputError when an image has another size than the first of its camera.
void LoadPoints(const DepthFrames& source, Frame* frame);
// Aligns the cameras to one another by the first frame (camera_alignment.h) where `alignment` is
// set. Warns of each camera whose pose could not be refined.
bool RefineByFirstFrame(const Frame& first, DepthFrames* source,
                        std::vector<std::string>* warnings);
// Intrinsics that do not belong to images of this size, and views that lie apart.
std::vector<std::string> DoubtsOfFirstFrame(const Frame& first, const DepthFrames& source);
std::string ExplainSize(const DepthFrames& source, double size, const std::string& length_unit);
// One line per camera: where it stands and what the refinement did to its pose.
std::vector<InfoLine> DescribeSource(const DepthFrames& source);

// Writes the depths that the cameras measure on each surface as frames/cameraC_NNN.png in `folder`,
// in counts of `scan.options.quantum`. Returns the entries of `frames:` in recording.yaml. Throws
// InputError when the quantum is 0 or too small for the depths to fit in 16 bits.
std::string WriteDepthFrames(const std::filesystem::path& folder, const VirtualScan& scan);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DEPTH_FRAMES_H_
