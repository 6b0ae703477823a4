// A picture of a search for missing physics: the error of each model that was fitted, and the noise
// of the measurement as a lower limit.
//
// Each model is a horizontal bar with its label and its error; the noise is a dashed vertical line.
// The model with the smallest error is blue, the others are grey. Drawn without a screen.
#ifndef LACUNA_REPORT_LEDGER_PICTURE_H_
#define LACUNA_REPORT_LEDGER_PICTURE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "record/ledger.h"
#include "report/panel_picture.h"

namespace lacuna {

struct LedgerBar {
  std::string label;  // ModelLabel: "with viscoelastic branch"
  double error = 0;   // rms, in LedgerPicture::unit
};

struct LedgerPicture {
  enum class Unit {
    kMetres,
    kNoise,  // the noise of each point: noise alone gives an error of 1
  };
  std::string title;                                 // names the error that the bars show
  std::vector<LedgerBar> models;                     // from top to bottom
  double noise = 0;                                  // rms, in `unit`; 0: draw no line
  std::string noise_label = "noise of the markers";  // beside the line
  Unit unit = Unit::kMetres;
};

// The held-out error of every model that could be fitted, or the error of the fitted frames where
// nothing was held out. Where points have noise of their own, as patches of scans do, no length
// holds for the noise of all of them, and each residual is divided by the noise of its point. At
// least one model is needed (CHECK).
LedgerPicture PictureOf(const Ledger& ledger);

// Writes a PNG that is 1800 pixels wide, with letters that are still readable at half that width;
// its height follows from the number of models. Returns kNoRenderer where OpenGL is not available
// through EGL. Throws InputError when the file cannot be written. At least one model is needed, and
// errors must be finite and not negative (CHECK).
PictureResult RenderLedgerPng(const std::filesystem::path& file, const LedgerPicture& picture);

}  // namespace lacuna

#endif  // LACUNA_REPORT_LEDGER_PICTURE_H_
