// A soft bar that is let go, or whose clamp is moved, seen by virtual depth cameras: what a
// prediction study of scans explains. Made with another mesh, another order of cells and smaller
// steps than the study's.
#ifndef LACUNA_TESTS_SUPPORT_SCANNED_BAR_H_
#define LACUNA_TESTS_SUPPORT_SCANNED_BAR_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/tet_mesh.h"
#include "scan/scan_writer.h"
#include "support/held_bar.h"

namespace lacuna {

inline constexpr int kScans = 16;              // at 50 Hz
inline constexpr double kScanNoise = 4e-4;     // m
inline constexpr double kScansUntil = 0.2001;  // s, of 0.3 s

// The boundary of the held bar (FilmHeldBar, its clock right) in all scans.
std::vector<TriMesh> HeldBarSurfaces(const HeldBarTruth& truth);

// The same bar without gravity, clamped over 10 mm and there carried along `path` (m, from rest).
std::vector<TriMesh> CarriedBarSurfaces(const HeldBarTruth& truth, const Eigen::Matrix3Xd& path);
// Aside by 15 mm and down by 6 mm within 0.1 s, then still; one column a scan.
Eigen::Matrix3Xd CarriedPath();

// What four cameras see of them, as a recording: recording.yaml, to which `rest` is added as it is,
// the frames and box.off.
void WriteBarScans(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces,
                   const std::string& rest, FrameWriter write_frames = WritePointFrames);

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_SCANNED_BAR_H_
