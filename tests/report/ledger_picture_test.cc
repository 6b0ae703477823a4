#include "report/ledger_picture.h"

#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>
#include <limits>

#include "support/small_ledger.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

LedgerPicture Example() {
  return {"held-out error", {{"model as given", 8e-4}, {"with damping", 2e-4}}, 1e-4, "noise"};
}

// All markers have the noise of a typical one.
Ledger WithEqualNoise(Ledger ledger) {
  for (LedgerModel& model : ledger.models)
    model.errors.rms_over_sigma =
        model.errors.held_out_rms / (std::sqrt(3.0) * ledger.models[0].record.noise);
  return ledger;
}

bool IsNear(const unsigned char* pixel, int red, int green, int blue) {
  constexpr int kTolerance = 8;  // of 255, for rounding of colours
  return std::abs(pixel[0] - red) < kTolerance && std::abs(pixel[1] - green) < kTolerance &&
         std::abs(pixel[2] - blue) < kTolerance;
}

// How many pixels have the colour of a bar, of the best bar, and of the noise line.
struct ColourCounts {
  int bar = 0, best = 0, noise = 0;
};

ColourCounts CountColours(const std::filesystem::path& file, int* width) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  *width = image->GetDimensions()[0];
  ColourCounts counts;
  for (int y = 0; y < image->GetDimensions()[1]; ++y) {
    for (int x = 0; x < *width; ++x) {
      const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer(x, y, 0));
      counts.bar += IsNear(pixel, 158, 166, 176);
      counts.best += IsNear(pixel, 31, 112, 181);
      counts.noise += IsNear(pixel, 199, 56, 41);
    }
  }
  return counts;
}

TEST(LedgerPicture, BarsAreProportionalToTheErrorsAndTheBestIsBlue) {
  const TemporaryFolder folder;
  const PictureResult result = RenderLedgerPng(folder / "ledger.png", Example());
  if (result.status == PictureResult::Status::kNoRenderer) GTEST_SKIP() << result.message;
  int width = 0;
  const ColourCounts counts = CountColours(folder / "ledger.png", &width);
  EXPECT_EQ(width, 1800);
  ASSERT_GT(counts.best, 1000);
  // Both bars are equally high, so their areas have the ratio of the errors: 4. The dashed line and
  // the smoothed edges cover a few per cent.
  EXPECT_NEAR(static_cast<double>(counts.bar) / counts.best, 4, 0.3);
  // The bars do not cover the line: half of 5 pixels over two rows of 110 pixels, and a little
  // more.
  EXPECT_GT(counts.noise, 5 * 110);
}

TEST(LedgerPicture, HasNoLineIfTheNoiseIsUnknown) {
  const TemporaryFolder folder;
  LedgerPicture picture = Example();
  picture.noise = 0;
  const PictureResult result = RenderLedgerPng(folder / "ledger.png", picture);
  if (result.status == PictureResult::Status::kNoRenderer) GTEST_SKIP() << result.message;
  int width = 0;
  EXPECT_EQ(CountColours(folder / "ledger.png", &width).noise, 0);
}

// The title of the effect, as on the page of the report, and not its name.
TEST(LedgerPicture, ShowsTheModelsThatCouldBeFittedUnderTheirLabels) {
  Ledger ledger = WithEqualNoise(SmallLedger());
  ledger.models.front().diagnosis->ranking.front().title = "Drag (of the surrounding air)";
  const LedgerPicture picture = PictureOf(ledger);
  ASSERT_EQ(picture.models.size(), 2u);
  EXPECT_EQ(picture.title, "bar: rms error in the held-out frames");
  EXPECT_EQ(picture.models[0].label, "initial model");
  EXPECT_EQ(picture.models[1].label, "with drag");
  EXPECT_EQ(picture.models[1].error, ledger.models[1].errors.held_out_rms);
  EXPECT_EQ(picture.unit, LedgerPicture::Unit::kMetres);
  EXPECT_DOUBLE_EQ(picture.noise, std::sqrt(3.0) * ledger.models[0].record.noise);
  ledger.models[1].record.usable = false;
  EXPECT_EQ(PictureOf(ledger).models.size(), 1u);
}

void ExpectErrorsOverTheNoiseOfEachPoint(const Ledger& ledger) {
  const LedgerPicture picture = PictureOf(ledger);
  EXPECT_EQ(picture.unit, LedgerPicture::Unit::kNoise);
  EXPECT_EQ(picture.title, "bar: rms error in the held-out frames, times the noise of each point");
  EXPECT_EQ(picture.noise, 1);
  ASSERT_EQ(picture.models.size(), 2u);
  EXPECT_EQ(picture.models[0].error, ledger.models[0].errors.rms_over_sigma);
  EXPECT_EQ(picture.models[1].error, ledger.models[1].errors.rms_over_sigma);
}

// The second model misses points that are more precise than a typical one.
TEST(LedgerPicture, DividesByTheNoiseOfEachPointWherePointsHaveTheirOwn) {
  Ledger ledger = WithEqualNoise(SmallLedger());
  ledger.models[1].errors.rms_over_sigma *= 1.5;
  ExpectErrorsOverTheNoiseOfEachPoint(ledger);
}

// A patch is a mean of some number of scanned points.
TEST(LedgerPicture, DividesByTheNoiseOfEachPatchOfAScan) {
  Ledger ledger = WithEqualNoise(SmallLedger());
  ledger.models[0].record.recordings[0].scan.emplace();
  ExpectErrorsOverTheNoiseOfEachPoint(ledger);
}

TEST(LedgerPictureDeathTest, RefusesAPictureWithoutModelsAndAnErrorThatIsNoNumber) {
  LedgerPicture picture;
  EXPECT_DEATH(RenderLedgerPng("never.png", picture), "no model");
  picture.models = {{"odd", std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_DEATH(RenderLedgerPng("never.png", picture), "odd");
}

}  // namespace
}  // namespace lacuna
