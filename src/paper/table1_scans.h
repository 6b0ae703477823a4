// What Figures 3 to 6 are drawn from: which frames and meshes, and the recording of Table 1.
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

// What is drawn. Frames are those of the recording, the first one 0.
struct Table1FigureSettings {
  std::filesystem::path table1;  // the folder of experiments
  int cloud_frame = 1;
  std::vector<double> radius_edge_ratios;  // q, the rows of Figure 4
  std::vector<double> max_volumes;         // v, m³, its columns
  std::vector<int> bend_frames;
  std::vector<int> alignment_frames;
};
Table1FigureSettings ReadTable1Figures(const Config& config);

// The recording of the first seed with what is made of it once for all figures.
struct Table1Scans {
  ReconstructionStudy study;  // of the first row
  std::vector<FrameState> states;
  TrackedFrames tracked;
};
// Takes the recording of `results` (where `lacuna table1` has been), or makes it in `folder`.
// Throws InputError for frames that the recording does not have.
Table1Scans PrepareScans(const Table1Study& table1, const Table1FigureSettings& settings,
                         const std::filesystem::path& results, const std::filesystem::path& folder,
                         Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_SCANS_H_
