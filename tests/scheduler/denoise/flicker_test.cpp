#include "scheduler/denoise/flicker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/denoise/shot_frames.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

const Truth kTwo = [](int, int) { return 2.0f; };

TEST(Flicker, OfIndependentNoiseIsTwiceItsVariance) {
  const Image a = frame_of(kTwo, 0.1f, 1), next = frame_of(kTwo, 0.1f, 2), truth = frame_of(kTwo, 0, 3);
  const auto measured = flicker({a, next}, {truth, truth}, 0.01);
  ASSERT_TRUE(measured) << measured.error().message;
  // Of 9216 squares of normal numbers: known to 1.5 %; four deviations.
  EXPECT_NEAR(*measured, 2 * 0.01 / 4.01, 0.06 * 2 * 0.01 / 4.01);
}

TEST(Flicker, OfErrorThatMovesWithThePointsIsNone) {
  // The image is brighter than the reference by a pattern that moves with the points, two pixels a frame.
  const auto frame = [](int shift, float more) {
    return frame_of(
        [=](int x, int y) {
          return ((x - shift + 64) % 5 == 0 ? 3.0f : 1.0f) + more * float((x - shift + y) % 3);
        },
        0, std::uint32_t(10 + shift), 2);
  };
  const auto moved = flicker({frame(0, 0.5f), frame(2, 0.5f)}, {frame(0, 0), frame(2, 0)}, 0.01);
  ASSERT_TRUE(moved) << moved.error().message;
  EXPECT_LT(*moved, 1e-10);  // rounding
  const auto stays = flicker({frame(0, 0.5f), frame(0, 0.5f)}, {frame(0, 0), frame(2, 0)}, 0.01);
  ASSERT_TRUE(stays);
  EXPECT_GT(*stays, 0.01);
}

TEST(Flicker, NeedsMotionAndPointsThatStay) {
  const Image frame = frame_of(kTwo, 0, 1);
  Image still = frame;
  still.channels[6] = "speed.X";
  const auto missing = flicker({still, still}, {still, still}, 0.01);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("motion"));
  EXPECT_TRUE(flicker({frame, frame}, {still, still}, 0.01)) << "the images know, too";
  const Image fast = frame_of(kTwo, 0, 2, kFrameWidth);
  EXPECT_FALSE(flicker({fast, fast}, {fast, fast}, 0.01)) << "all points leave the image";
}

}  // namespace
}  // namespace penumbra
