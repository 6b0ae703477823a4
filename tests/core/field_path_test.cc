#include "core/field_path.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(FieldPath, NamesEntriesAndFindsThemWithinOthers) {
  EXPECT_EQ(EntryOf("", "mesh"), "mesh");
  EXPECT_EQ(EntryOf("effects[1]", "eta"), "effects[1].eta");
  EXPECT_TRUE(LiesWithin("mesh", "mesh"));
  EXPECT_TRUE(LiesWithin("mesh.order", "mesh"));
  EXPECT_TRUE(LiesWithin("effects[1].eta", "effects"));
  EXPECT_FALSE(LiesWithin("meshing", "mesh"));
  EXPECT_FALSE(LiesWithin("mesh", "mesh.order"));
}

}  // namespace
}  // namespace lacuna
