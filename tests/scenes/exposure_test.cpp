// When the shutter is open, by its settings and the file's.
#include "scenes/motion/exposure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "scenes/motion/scene_motion.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;

/// A scene at 3 s, of 8 frames a second: all numbers below are exact.
SceneDescription scene_of(double shutter_of_file = 0.0) {
  SceneDescription scene;
  scene.time = 3.0;
  scene.frame_duration = 0.125;
  SceneMotion motion;
  motion.shutter = shutter_of_file;
  scene.motion = std::make_shared<const SceneMotion>(std::move(motion));
  return scene;
}

TEST(ExposureOf, AStillIsOfOneInstant) {
  SceneDescription still = scene_of();
  for (const bool moves : {true, false}) {
    if (!moves) still.motion.reset();
    const Exposure e = exposure_of(still);
    EXPECT_EQ(e.open, 3.0);
    EXPECT_EQ(e.close, 3.0);
    EXPECT_EQ(e.middle(), 3.0);
    EXPECT_EQ(e.exposure, 1.0);
    EXPECT_EQ(e.rolling, 0.0);
    EXPECT_THAT(e.curve, ElementsAre(1.0, 1.0));
    EXPECT_EQ(e.before, 2.875);
    EXPECT_EQ(e.after, 3.125);
  }
}

TEST(ExposureOf, AFilesShutterOpensAtTheFramesTime) {
  SceneDescription scene = scene_of(0.5);
  EXPECT_EQ(exposure_of(scene).open, 3.0);
  EXPECT_EQ(exposure_of(scene).close, 3.5);
  EXPECT_EQ(exposure_of(scene).before, 3.125);
  EXPECT_EQ(exposure_of(scene).after, 3.375);
  scene.camera.shutter = 0.0f;
  EXPECT_EQ(exposure_of(scene).close, 3.0) << "the setting comes first";
}

TEST(ExposureOf, ThePositionIsThatOfTheFramesTime) {
  SceneDescription scene = scene_of(0.5);
  scene.camera.shutter = 0.5f;
  const auto times = [&](ShutterPosition position) {
    scene.camera.shutter_position = position;
    const Exposure e = exposure_of(scene);
    EXPECT_EQ(e.exposure, 1.0);
    EXPECT_EQ(e.middle() - e.before, 0.125);
    EXPECT_EQ(e.after - e.middle(), 0.125);
    return std::pair(e.open, e.close);
  };
  EXPECT_EQ(times(ShutterPosition::kStart), std::pair(3.0, 3.0625));
  EXPECT_EQ(times(ShutterPosition::kCenter), std::pair(2.96875, 3.03125));
  EXPECT_EQ(times(ShutterPosition::kEnd), std::pair(2.9375, 3.0));
}

TEST(ExposureOf, TheLastRowOfARollingShutterStartsLater) {
  SceneDescription scene = scene_of();
  scene.camera.shutter = 0.5f;
  scene.camera.rolling_shutter = 1.5;
  Exposure e = exposure_of(scene);
  EXPECT_EQ(e.open, 3.0);
  EXPECT_EQ(e.close, 3.25);
  EXPECT_EQ(e.exposure, 0.25);
  EXPECT_EQ(e.rolling, 0.75);
  scene.camera.shutter_position = ShutterPosition::kCenter;
  EXPECT_EQ(exposure_of(scene).open, 2.875) << "the frame's time is the middle of all rows";
  // Rows of an instant each.
  scene.camera.shutter = 0.0f;
  e = exposure_of(scene);
  EXPECT_EQ(e.close - e.open, 0.1875);
  EXPECT_EQ(e.exposure, 0.0);
  EXPECT_EQ(e.rolling, 1.0);
}

TEST(ExposureOf, CurvesAreSharesOfTheirLargestValue) {
  SceneDescription scene = scene_of();
  scene.camera.shutter_curve = {0.0, 2.0, 1.0, 0.5};
  EXPECT_THAT(exposure_of(scene).curve, ElementsAre(0.0, 1.0, 0.5, 0.25));
  scene.camera.shutter_curve = {1e300, 0.0};
  EXPECT_THAT(exposure_of(scene).curve, ElementsAre(1.0, 0.0));
}

}  // namespace
}  // namespace penumbra
