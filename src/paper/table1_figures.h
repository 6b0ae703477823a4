// Figures 3 to 6 of Transue & Choi 2015, from the recording and the searches of Table 1:
//   3  the cleaned points of a scan, and the surface made from them
//   4  tetrahedral meshes of the undeformed surface, cut open: at two q and two v, and with the
//      surface's own triangles at several q
//   5  the bend: registered displacements on the scans' surfaces, and the simulation
//   6  the optima of the three searches over the scans' surfaces, coloured by their distance
#ifndef LACUNA_PAPER_TABLE1_FIGURES_H_
#define LACUNA_PAPER_TABLE1_FIGURES_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "paper/table1_scans.h"
#include "report/panel_picture.h"

namespace lacuna {

// A figure: its picture, and its numbers as text and JSON.
struct FigureContent {
  PanelPicture picture;
  PanelOptions options;
  std::string text;
  nlohmann::json numbers;
};
FigureContent DrawCloudAndSurface(const Table1Scans& scans, const Table1FigureSettings& settings);
FigureContent DrawMeshes(const Table1Study& table1, const Table1Scans& scans,
                         const Table1FigureSettings& settings);
// DrawMeshes() where S_0's own triangles are kept and v does not act, so that q does.
FigureContent DrawOwnSurfaceMeshes(const Table1Study& table1, const Table1Scans& scans,
                                   const Table1FigureSettings& settings);
// Throws InputError where the registration of one of its frames failed.
FigureContent DrawBend(const Table1Study& table1, const Table1Scans& scans,
                       const Table1FigureSettings& settings);
// `results` holds table1.json. Throws InputError when it is missing or belongs to another
// recording.
FigureContent DrawAlignment(const Table1Study& table1, const Table1Scans& scans,
                            const Table1FigureSettings& settings,
                            const std::filesystem::path& results);

// Writes NAME.png, NAME.txt and NAME.json. The status is that of the picture.
PictureResult WriteFigure(const FigureContent& figure, const std::string& name,
                          const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_FIGURES_H_
