#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>

#include "effects/catalogue.h"

namespace lacuna {
namespace {

TEST(EffectFiles, AreAllUnderstood) {
  const auto material = MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}});
  const std::filesystem::path folder =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "configs" / "effects";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    const Config config = Config::Load(entry.path());
    EXPECT_NO_THROW({
      MakeEffect(config, material.get(), Eigen::Vector3d(0, 0, -9.80665));
      config.RefuseUnknownKeys();
    }) << entry.path();
  }
  EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace lacuna
