// Animations in Mitsuba's files: the scene at shutter open.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/mitsuba/animation.h"
#include "scenes/transform.h"
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

class MitsubaAnimations : public SceneText {
 protected:
  static std::string animation(std::string_view name, std::string_view keys) {
    return "<animation name='" + std::string(name) + "'>" + std::string(keys) + "</animation>";
  }
  static std::string sensor(double open) {
    return "<sensor type='perspective'><float name='shutter_open' value='" + std::to_string(open) +
           "'/><float name='shutter_close' value='9'/></sensor>";
  }
  /// Where the group's origin is.
  glm::dvec3 place(double open, std::string_view keys) {
    const SceneDescription s =
        good(sensor(open) + in("shape", "shapegroup", in("shape", "sphere")).insert(6, " id='g'") +
             in("shape", "instance", "<ref id='g'/>" + animation("animation", keys)));
    EXPECT_THAT(s.warnings, ::testing::Contains(HasSubstr("when the shutter opens")));
    return s.instances.size() == 1 ? glm::dvec3(s.instances[0].to_world[3]) : glm::dvec3(1e9);
  }
};

constexpr std::string_view kKeys =
    "<transform time='1'><translate x='2'/></transform><transform time='3'><translate x='6' "
    "y='4'/></transform>";

TEST_F(MitsubaAnimations, AreWhatTheyAreWhenTheShutterOpens) {
  EXPECT_EQ(place(0, kKeys), glm::dvec3(2, 0, 0));  // before the first key
  EXPECT_EQ(place(1, kKeys), glm::dvec3(2, 0, 0));
  EXPECT_EQ(place(1.5, kKeys), glm::dvec3(3, 1, 0));
  EXPECT_EQ(place(3, kKeys), glm::dvec3(6, 4, 0));
  EXPECT_EQ(place(7, kKeys), glm::dvec3(6, 4, 0));
}

TEST_F(MitsubaAnimations, RotationsTurnEvenlyAndStretchesGrow) {
  using mitsuba::AnimationValue;
  const glm::dmat4 from = rotation({0, 0, 1}, -75) * scaling({1, 2, 3}),
                   to = rotation({0, 0, 1}, 75) * scaling({3, 2, 1});
  const AnimationValue turn{{{0, from}, {1, to}}};
  // 150 degrees in a unit of time.
  const glm::dmat4 wanted = rotation({0, 0, 1}, -75 + 150 * 0.23) * scaling({1.46, 2, 2.54});
  const glm::dmat4 made = mitsuba::transform_at(turn, 0.23);
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(made[i / 4][i % 4], wanted[i / 4][i % 4], 1e-12) << i;
  EXPECT_EQ(mitsuba::transform_at(turn, 0.0), from);
  // A mirror stays one on both sides.
  const AnimationValue mirrors{{{0, scaling({-1, 1, 1})}, {1, translation({2, 0, 0}) * scaling({-1, 1, 1})}}};
  const glm::dmat4 half = mitsuba::transform_at(mirrors, 0.5),
                   mirror = translation({1, 0, 0}) * scaling({-1, 1, 1});
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(half[i / 4][i % 4], mirror[i / 4][i % 4], 1e-12) << i;
}

TEST_F(MitsubaAnimations, MoveCamerasAndLights) {
  const SceneDescription s = good("<sensor type='perspective'>" + animation("toWorld", kKeys) + "</sensor>" +
                                  in("emitter", "point", animation("to_world", kKeys)));
  EXPECT_EQ(glm::dvec3(s.camera.to_world[3]), glm::dvec3(2, 0, 0));
  EXPECT_THAT(s.warnings, ::testing::Contains(HasSubstr("2 animations are as at time 0")));
}

TEST_F(MitsubaAnimations, WhatIsWrongIsSaid) {
  const auto wrong = [&](std::string_view keys) {
    return error(scene(in("emitter", "point", animation("to_world", keys))));
  };
  EXPECT_THAT(wrong(""), HasSubstr("holds at least one"));
  EXPECT_THAT(wrong("<transform time='1'/><transform time='1'/>"), HasSubstr("must ascend; 1 follows 1"));
  EXPECT_THAT(wrong("<transform/>"), HasSubstr("time"));
  EXPECT_THAT(wrong("<float name='a' value='1'/>"), HasSubstr("no <float>"));
  EXPECT_THAT(wrong("<transform time='0'><scale x='0'/></transform>"), HasSubstr("singular"));
  // Turned inside out between two keys.
  EXPECT_THAT(error(scene(sensor(0.5) + in("emitter", "point",
                                           animation("to_world",
                                                     "<transform time='0'/><transform time='1'><scale "
                                                     "x='-1' y='-1' z='-1'/></transform>")))),
              HasSubstr("singular at time 0.5"));
}

}  // namespace
}  // namespace penumbra
