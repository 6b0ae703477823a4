#include "report/ledger_picture.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "report/offscreen_window.h"
#include "report/page_drawing.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

// Sizes in pixels.
constexpr double kWidth = 1800, kMargin = 50;
constexpr double kTitleSize = 42, kLabelSize = 38, kSmallSize = 32;
constexpr double kTitleHeight = 110, kFooterHeight = 90;
constexpr double kRowHeight = 110, kBarHeight = 64;
constexpr double kGap = 24;  // between a bar and the text beside it
constexpr double kLineWidth = 5, kDash = 16;

const Eigen::Vector3d kBestColour{0.12, 0.44, 0.71}, kBarColour{0.62, 0.65, 0.69};
const Eigen::Vector3d kNoiseColour{0.78, 0.22, 0.16}, kAxisColour{0.3, 0.3, 0.3};

std::string ErrorText(double error, LedgerPicture::Unit unit) {
  return unit == LedgerPicture::Unit::kNoise ? fmt::format("{:.1f} times", error)
                                             : fmt::format("{:.3f} mm", 1e3 * error);
}

// The area of the bars on the page, in pixels.
struct BarArea {
  double left = 0, right = 0;  // positions of the errors 0 and `largest`
  double bottom = 0, top = 0;
  double largest = 1;  // in the picture's unit

  double PlaceOf(double error) const { return left + (right - left) * error / largest; }
};

BarArea LayOutBars(const LedgerPicture& picture, double height) {
  BarArea area;
  double label_width = 0, value_width = 0;
  area.largest = picture.noise;
  for (const LedgerBar& bar : picture.models) {
    area.largest = std::max(area.largest, bar.error);
    label_width = std::max(label_width, TextWidth(bar.label, kLabelSize));
    value_width = std::max(value_width, TextWidth(ErrorText(bar.error, picture.unit), kLabelSize));
  }
  if (area.largest == 0) area.largest = 1;
  area.left = kMargin + label_width + kGap;
  area.right = std::max(kWidth - kMargin - value_width - kGap, area.left + 1);
  area.bottom = kFooterHeight;
  area.top = height - kTitleHeight;
  return area;
}

void DrawBars(const LedgerPicture& picture, const BarArea& area, vtkRenderer* page) {
  const auto best =
      std::min_element(picture.models.begin(), picture.models.end(),
                       [](const LedgerBar& a, const LedgerBar& b) { return a.error < b.error; });
  for (auto bar = picture.models.begin(); bar != picture.models.end(); ++bar) {
    const double row = static_cast<double>(bar - picture.models.begin());
    const double middle = area.top - (row + 0.5) * kRowHeight;
    const double end = area.PlaceOf(bar->error);
    DrawRectangle({area.left, middle - 0.5 * kBarHeight}, {end - area.left, kBarHeight},
                  bar == best ? kBestColour : kBarColour, page);
    DrawText(bar->label, area.left - kGap, middle, TextAnchor::kRight, kLabelSize, page);
    // Where the bar ends just before the noise line, the text starts behind that line.
    const double noise = area.PlaceOf(picture.noise);
    const double text = noise > end && noise < end + 2 * kGap ? noise + kLineWidth : end;
    DrawText(ErrorText(bar->error, picture.unit), text + kGap, middle, TextAnchor::kLeft,
             kLabelSize, page);
  }
  DrawRectangle({area.left - 2, area.bottom}, {4, area.top - area.bottom}, kAxisColour, page);
}

void DrawNoise(const LedgerPicture& picture, const BarArea& area, vtkRenderer* page) {
  if (!(picture.noise > 0)) return;
  const double x = area.PlaceOf(picture.noise);
  for (double y = area.bottom - kDash; y < area.top; y += 2 * kDash)
    DrawRectangle({x - 0.5 * kLineWidth, y}, {kLineWidth, std::min(kDash, area.top - y)},
                  kNoiseColour, page);
  const std::string text =
      fmt::format("{}: {}", picture.noise_label, ErrorText(picture.noise, picture.unit));
  const double left = std::min(x, kWidth - kMargin - TextWidth(text, kSmallSize));
  DrawText(text, left, area.bottom - kDash - 0.8 * kSmallSize, TextAnchor::kLeft, kSmallSize, page);
}

// The length that noise alone gives to the error of a model, as the first model's fit assumed it.
// Nothing where points have noise of their own, so that no single length holds.
std::optional<double> CommonNoise(const Ledger& ledger) {
  for (const LedgerModel& model : ledger.models) {
    const std::optional<double> noise = RmsOfNoise(model.record);
    if (!noise || (model.record.usable &&
                   !HaveEqualNoise(model.errors.held_out_rms, model.errors.rms_over_sigma, *noise)))
      return std::nullopt;
  }
  return RmsOfNoise(ledger.models.front().record);
}

}  // namespace

LedgerPicture PictureOf(const Ledger& ledger) {
  CHECK(!ledger.models.empty());
  const LedgerModel& first = ledger.models.front();
  const std::optional<double> noise = CommonNoise(ledger);
  LedgerPicture picture;
  picture.title = fmt::format("{}: rms error in the {} frames", first.name,
                              first.errors.has_held_out ? "held-out" : "fitted");
  if (noise) {
    picture.noise = *noise;
  } else {
    picture.title += ", times the noise of each point";
    picture.unit = LedgerPicture::Unit::kNoise;
    picture.noise = 1;
    picture.noise_label = "noise of the measurement";
  }
  for (size_t k = 0; k < ledger.models.size(); ++k) {
    const LedgerModel& model = ledger.models[k];
    if (!model.record.usable) continue;
    const std::string label = ModelLabel(
        k, model.added, model.parent < 0 ? std::nullopt : ledger.models[model.parent].diagnosis);
    picture.models.push_back(
        {label, noise ? model.errors.held_out_rms : model.errors.rms_over_sigma});
  }
  return picture;
}

PictureResult RenderLedgerPng(const std::filesystem::path& file, const LedgerPicture& picture) {
  CHECK(!picture.models.empty()) << "there is no model to draw";
  for (const LedgerBar& bar : picture.models)
    CHECK(std::isfinite(bar.error) && bar.error >= 0) << bar.label;
  const double height =
      kTitleHeight + kRowHeight * static_cast<double>(picture.models.size()) + kFooterHeight;
  OffscreenWindow window(static_cast<int>(kWidth), static_cast<int>(height));
  if (!window.IsUsable()) return NoRenderer();
  const BarArea area = LayOutBars(picture, height);
  vtkNew<vtkRenderer> page;
  page->SetBackground(1, 1, 1);
  DrawText(picture.title, 0.5 * kWidth, height - 0.5 * kTitleHeight, TextAnchor::kCentre,
           kTitleSize, page);
  DrawNoise(picture, area, page);  // first, so that the bars do not cover the line
  DrawBars(picture, area, page);
  window.Add(page);
  window.WritePng(file);
  return {PictureResult::Status::kWritten, ""};
}

}  // namespace lacuna
