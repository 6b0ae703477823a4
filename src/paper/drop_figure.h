// Output of Figure 1 of Transue & Choi 2015 (paper/drop_study.h): pictures, a chart, a table and
// JSON.
#ifndef LACUNA_PAPER_DROP_FIGURE_H_
#define LACUNA_PAPER_DROP_FIGURE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "paper/drop_run.h"
#include "report/panel_picture.h"

namespace lacuna {

// Three tables as plain text: the quantities of every run, their relative change when the time step
// is halved, and their relative difference from the finest run, which has the most nodes among the
// runs of the highest element order. `runs` must not be empty.
std::string DropText(const std::vector<DropRun>& runs);

// One column for each mesh of this element order, one row for each instant of the study: the body
// on the floor, coloured by its largest principal strain. Without panels if no mesh has this order.
PanelPicture DropPicture(const DropStudy& study, const std::vector<DropRun>& runs, int order);

// Writes figure1.txt, figure1.json and figure1_height.svg, and for each element order that occurs
// figure1_linear.png or figure1_quadratic.png. Returns the status of the pictures; throws
// InputError if a text file cannot be written.
PictureResult WriteDropFigure(const DropStudy& study, const std::vector<DropRun>& runs,
                              const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PAPER_DROP_FIGURE_H_
