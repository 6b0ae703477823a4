// The data of Figures 3 to 6: the recording of Table 1, and the choice of frames and meshes.
#ifndef LACUNA_PAPER_TABLE1_SCANS_H_
#define LACUNA_PAPER_TABLE1_SCANS_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "paper/table1.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/tracked_frames.h"

namespace lacuna {

// What is drawn. Frames are numbered from 0 as in the recording.
struct Table1FigureSettings {
  std::filesystem::path table1;  // the folder of experiments
  int cloud_frame = 1;
  std::vector<double> radius_edge_ratios;  // q, the rows of Figure 4
  std::vector<double> max_volumes;         // v, m³, the columns of Figure 4
  // The second part of Figure 4: S_0's own triangles, kept, with meshes that differ in q alone.
  struct OwnSurface {
    std::vector<double> radius_edge_ratios;
    double max_volume = 1;          // m³; as large as the body: no bound
    double min_dihedral_angle = 0;  // rad
  };
  OwnSurface own_surface;
  std::vector<int> bend_frames;
  std::vector<int> alignment_frames;
};
Table1FigureSettings ReadTable1Figures(const Config& config);

// The recording of the first seed, processed once for all figures.
struct Table1Scans {
  ReconstructionStudy study;  // that of the first row
  std::vector<FrameState> states;
  TrackedFrames tracked;
};
// Uses the recording in `results`, where `lacuna table1` has written one, or makes it in `folder`.
// Throws InputError for frames that the recording does not have, and Interrupted.
Table1Scans PrepareScans(const Table1Study& table1, const Table1FigureSettings& settings,
                         const std::filesystem::path& results, const std::filesystem::path& folder,
                         Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_SCANS_H_
