// The kinds of frames that a recording may have.
//
// A kind is a struct (a "source") with a header of its own, which contains everything that depends
// on the kind. To add one, write that header, its test and its entry in docs/recording.md, and add
// the struct to FrameSource below; nothing else in Lacuna depends on the kind of a recording. The
// struct has the constants
//
//   kKind    its name in recording.yaml ("points")
//   kTitle   what its frames are called in messages ("point clouds")
//
// and these functions, overloaded by the struct. One that derives from FileFrames (file_frames.h)
// inherits all but ReadSource and LoadPoints, and overloads what differs:
//
//   ReadSource          fills the struct from the mapping `frames` of recording.yaml, the times
//                       excepted; appends to `warnings`
//   LoadPoints          fills the points, triangles, sensors and counts of a Frame whose `index` is
//                       set, in SI and in the world frame; throws InputError when it cannot
//   CountFrames, TimesInFiles, KeepFrames       the frames before and after some are chosen
//   FilesWithHeaders                            the files whose headers have values for each frame
//   FilesOfFrame, AllFiles                      the files behind one frame and behind all of them
//   IsTracked, ShowsSurface, NamedMarkers       what the frames can be used for
//   RefineByFirstFrame                          improves the source once the first frame is known
//   DoubtsOfFirstFrame                          warnings about the source itself
//   ExplainSize, DescribeSource                 text for warnings and for `lacuna info`
//
// A kind that the virtual scanner or the sealed trials can make has its writer beside them.
#ifndef LACUNA_SCAN_FRAME_SOURCE_H_
#define LACUNA_SCAN_FRAME_SOURCE_H_

#include <string>
#include <variant>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/depth_frames.h"
#include "scan/marker_frames.h"
#include "scan/mesh_frames.h"
#include "scan/point_frames.h"

namespace lacuna {

using FrameSource = std::variant<PointFrames, MeshFrames, DepthFrames, MarkerFrames>;

// Reads `kind` from the mapping `frames` and then all that the kind has, its times excepted. Throws
// InputError (file, line, column and field); the message for an unknown kind lists the kinds.
FrameSource ReadFrameSource(const Config& frames, const DataLocation& data,
                            std::vector<std::string>* warnings);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_SOURCE_H_
