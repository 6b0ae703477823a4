// Writes what virtual cameras see as an ordinary recording folder.
#ifndef LACUNA_SCAN_SCAN_WRITER_H_
#define LACUNA_SCAN_SCAN_WRITER_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"
#include "scan/recording.h"
#include "scan/virtual_scanner.h"

namespace lacuna {

enum class ScanOutput {
  kPoints,  // unordered points, PLY
  kDepth    // a 16-bit PNG of each camera; counts of `quantum`
};

// What the recording tells about the object, beside its frames.
struct ScannedObject {
  std::string name;
  std::optional<double> density;           // kg/m³
  std::optional<Eigen::Vector3d> gravity;  // m/s²
  std::vector<Region> fixed;
  std::vector<RecordedGrip> grips;  // following the scan, or along a given path
  std::vector<MeasuredForce> forces;
};

// Scans surface i at times[i] (s, ascending) and writes `folder`: recording.yaml, the frames, and
// truth/ with the surfaces themselves, of which the recording says nothing. All surfaces share the
// triangles of the first. recording.yaml comes last: without it the folder is no recording. Throws
// InputError when the folder cannot be written, a camera sees nothing, or (kDepth) the quantum is 0
// or too small for 16 bits.
void WriteScan(const std::filesystem::path& folder, const ScannedObject& object,
               const std::vector<TriMesh>& surfaces, const std::vector<double>& times,
               const std::vector<VirtualCamera>& cameras, const ScannerOptions& options,
               ScanOutput output);

// For tests: the surface that frame i is a scan of.
TriMesh ReadTrueSurface(const std::filesystem::path& folder, int i);

}  // namespace lacuna

#endif  // LACUNA_SCAN_SCAN_WRITER_H_
