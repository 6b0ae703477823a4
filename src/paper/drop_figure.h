// Figure 1 as pictures, a chart, a table and JSON.
#ifndef LACUNA_PAPER_DROP_FIGURE_H_
#define LACUNA_PAPER_DROP_FIGURE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "paper/drop_study.h"
#include "report/panel_picture.h"

namespace lacuna {

// The numbers of every run, how far the halved steps move them, and how far each is from the run
// with the most nodes of the highest order.
std::string DropText(const std::vector<DropRun>& runs);

// A column for each mesh of this order, a row for each instant: the bodies on their floor, coloured
// by their strain.
PanelPicture DropPicture(const DropStudy& study, const std::vector<DropRun>& runs, int order);

// figure1.txt, figure1.json, figure1_height.svg, and figure1_linear.png and figure1_quadratic.png
// where there are meshes of that order. The status is that of the pictures.
PictureResult WriteDropFigure(const DropStudy& study, const std::vector<DropRun>& runs,
                              const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PAPER_DROP_FIGURE_H_
