#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(DisjointSets, AreRepresentedByTheirSmallestElementAfterMerge) {
  DisjointSets sets(6);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(sets.Find(i), i);
  sets.Merge(5, 3);
  sets.Merge(4, 2);
  sets.Merge(3, 4);
  for (const int i : {2, 3, 4, 5}) EXPECT_EQ(sets.Find(i), 2) << i;
  EXPECT_EQ(sets.Find(0), 0);
  EXPECT_EQ(sets.Find(1), 1);
}

TEST(DisjointSets, KeepTheRepresentativeOfTheSetIntoWhichOneIsMerged) {
  DisjointSets sets(5);
  sets.MergeInto(0, 2);
  sets.MergeInto(1, 2);
  sets.MergeInto(2, 4);
  for (const int i : {0, 1, 2, 4}) EXPECT_EQ(sets.Find(i), 4) << i;
  EXPECT_EQ(sets.Find(3), 3);
}

}  // namespace
}  // namespace lacuna
