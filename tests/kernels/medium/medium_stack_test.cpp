// The medium of a ray, from the boundaries that it crossed.
#include <gtest/gtest.h>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

constexpr MediumStack kNowhere = {0, 0};

class MediumStackTest : public ::testing::Test {
 protected:
  MediumStackTest() {
    tables_.media.resize(6);
    tables_.boundaries = {{.interior = 1, .exterior = -1, .shape = 0},
                          {.interior = 2, .exterior = -1, .shape = 1},
                          {.interior = 0, .exterior = -1, .shape = 2},
                          {.interior = 3, .exterior = 1, .shape = 3},
                          {.interior = 1, .exterior = 4, .shape = 4}};
    scene_ = tables_.scene();
  }
  Crossing into(int boundary, MediumStack media) { return cross_boundary(&scene_, boundary, true, media); }
  Crossing out_of(int boundary, MediumStack media) { return cross_boundary(&scene_, boundary, false, media); }

  SceneTables tables_;
  Scene scene_{};
};

TEST_F(MediumStackTest, InNestedMediaWhatIsAroundComesBack) {
  const Crossing outer = into(0, kNowhere), inner = into(1, outer.media), bubble = into(2, inner.media);
  EXPECT_TRUE(outer.consistent && inner.consistent && bubble.consistent);
  EXPECT_EQ(innermost(outer.media), 1);
  EXPECT_EQ(innermost(inner.media), 2);
  EXPECT_EQ(innermost(bubble.media), 0);
  const Crossing a = out_of(2, bubble.media), b = out_of(1, a.media), c = out_of(0, b.media);
  EXPECT_TRUE(a.consistent && b.consistent && c.consistent);
  EXPECT_EQ(innermost(a.media), 2);
  EXPECT_EQ(innermost(b.media), 1);
  EXPECT_EQ(innermost(c.media), 0);
}

TEST_F(MediumStackTest, WhatAFileSaysOfTheOutsideIsChecked) {
  const MediumStack around = within(kNowhere, 1);
  EXPECT_TRUE(into(3, around).consistent);
  EXPECT_FALSE(into(3, kNowhere).consistent);
  EXPECT_EQ(innermost(out_of(3, into(3, around).media).media), 1);
  // A camera inside: outside is what the file says.
  const Crossing left = out_of(4, around);
  EXPECT_TRUE(left.consistent);
  EXPECT_EQ(innermost(left.media), 4);
}

TEST_F(MediumStackTest, OverlapsAreNoticed) {
  const MediumStack both = into(1, into(0, kNowhere).media).media;
  const Crossing left = out_of(0, both);
  EXPECT_FALSE(left.consistent);
  EXPECT_EQ(innermost(left.media), 2);
  EXPECT_EQ(innermost(out_of(1, left.media).media), 0);
  EXPECT_FALSE(out_of(0, kNowhere).consistent);
}

TEST_F(MediumStackTest, TheSameMediumOverlappingIsAUnion) {
  const MediumStack twice = into(0, into(0, kNowhere).media).media;
  const Crossing once = out_of(0, twice);
  EXPECT_TRUE(once.consistent);
  EXPECT_EQ(innermost(once.media), 1);
  EXPECT_EQ(innermost(out_of(0, once.media).media), 0);
}

TEST_F(MediumStackTest, HoldsEightAndSaysWhenThereAreMore) {
  MediumStack media = kNowhere;
  for (int i = 0; i < MOST_NESTED_MEDIA; ++i) {
    const Crossing in = into(i % 2, media);
    EXPECT_TRUE(in.consistent) << i;
    media = in.media;
  }
  EXPECT_FALSE(into(0, media).consistent);
  for (int i = MOST_NESTED_MEDIA - 1; i >= 0; --i) {
    EXPECT_EQ(innermost(media), i % 2 == 0 ? 1 : 2) << i;
    media = out_of(i % 2, media).media;
  }
  EXPECT_EQ(innermost(media), 0);
}

}  // namespace
}  // namespace penumbra
