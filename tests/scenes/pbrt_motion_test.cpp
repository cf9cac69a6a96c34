// ActiveTransform and TransformTimes in pbrt's files.
#include <gmock/gmock.h>

#include <cmath>

#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/transform.h"
#include "tests/scenes/pbrt_text.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtMotion : public PbrtText {
 protected:
  static SceneDescription at(const SceneDescription& scene, double time) {
    SceneDescription moved = scene;
    const auto done = set_time(moved, time);
    EXPECT_TRUE(done) << done.error().message;
    return moved;
  }
  static std::string at_end(std::string_view directives) {
    return "ActiveTransform EndTime\n" + std::string(directives) + "\nActiveTransform All\n";
  }
  static constexpr const char* kCamera = "Camera \"perspective\"";
};

void expect_near_matrix(const glm::dmat4& made, const glm::dmat4& wanted) {
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(made[i / 4][i % 4], wanted[i / 4][i % 4], 1e-12) << i;
}

TEST_F(PbrtMotion, ShapesMoveBetweenTheTimes) {
  const SceneDescription s =
      good_pbrt("Translate 1 0 0\n" + at_end("Translate 0 4 0 Rotate 90 0 0 1") + kTriangle,
                "TransformTimes 1 3 Camera \"perspective\"");
  ASSERT_NE(s.motion, nullptr);
  EXPECT_EQ(time_range(*s.motion), std::pair(1.0, 3.0));
  // The shutter opens at 0, and by default closes at 1.
  expect_near(mesh(s).positions[1], {2, 0, 0});
  EXPECT_THAT(warnings(s), IsEmpty());
  EXPECT_EQ(exposure_of(s).open, 0);
  EXPECT_EQ(exposure_of(s).close, 1);
  const double half = std::sqrt(0.5);
  expect_near(mesh(at(s, 2)).positions[0], {1, 2, 0});
  expect_near(mesh(at(s, 2)).positions[1], {1 + half, 2 + half, 0});
  // Before and after the times they stay.
  expect_near(mesh(at(s, -5)).positions[1], {2, 0, 0});
  expect_near(mesh(at(s, 9)).positions[1], {1, 5, 0});
}

TEST_F(PbrtMotion, EachMatrixHasItsDirectives) {
  const SceneDescription s = good_pbrt(
      std::string(
          "AttributeBegin ActiveTransform StartTime Translate 1 0 0 ActiveTransform EndTime Scale 2 2 2 "
          "Translate 0 1 0 CoordinateSystem \"there\" AttributeEnd\n") +
      // A name stands for both, whichever are active; a block's end restores what is active.
      "AttributeBegin ActiveTransform StartTime CoordSysTransform \"there\"\n" + kTriangle +
      "AttributeEnd\nTranslate 0 0 7\n" + kTriangle);
  expect_near(mesh(s).positions[1], {2, 0, 0});
  expect_near(mesh(at(s, 1)).positions[1], {2, 2, 0});
  expect_near(mesh(at(s, 1), 1).positions[1], {1, 0, 7});
  ASSERT_EQ(s.motion->shapes.size(), 1u);
}

TEST_F(PbrtMotion, TheShutterOpensAtAStillsTime) {
  const SceneDescription s =
      good_pbrt(at_end("Translate 4 0 0") + kTriangle,
                "Camera \"perspective\" \"float shutteropen\" 0.75 \"float shutterclose\" 0.25");
  expect_near(mesh(s).positions[0], {1, 0, 0});
  EXPECT_EQ(s.time, 0.25);
  EXPECT_EQ(exposure_of(s).open, 0.25);
  EXPECT_EQ(exposure_of(s).close, 0.75);
  EXPECT_EQ(good_pbrt(kTriangle).motion, nullptr) << "the default shutter alone moves nothing";
}

TEST_F(PbrtMotion, QuadricsStayWhatTheyAre) {
  const std::string shapes =
      "Shape \"sphere\" \"float radius\" 2\nShape \"disk\" \"float height\" 1\nShape \"cylinder\"\n";
  const SceneDescription s = good_pbrt(at_end("Translate 4 0 0 Rotate 90 0 1 0 Scale 3 3 3") + shapes);
  const SceneDescription end = at(s, 1), half = at(s, 0.5);
  EXPECT_NEAR(std::get<Sphere>(end.shapes.at(0).geometry).radius, 6, 1e-12);
  EXPECT_NEAR(std::get<Sphere>(half.shapes[0].geometry).radius, 4, 1e-12);
  expect_near(std::get<Sphere>(half.shapes[0].geometry).center, {2, 0, 0});
  expect_near(std::get<Disk>(end.shapes.at(1).geometry).center, {7, 0, 0});
  expect_near(std::get<Disk>(end.shapes[1].geometry).normal, {1, 0, 0});
  EXPECT_NEAR(std::get<Cylinder>(end.shapes.at(2).geometry).length, 6, 1e-12);
  // One that becomes another kind is a mesh.
  const SceneDescription flat = good_pbrt(at_end("Scale 1 1 3") + shapes);
  EXPECT_TRUE(std::holds_alternative<Mesh>(flat.shapes[0].geometry));
  EXPECT_TRUE(std::holds_alternative<Disk>(flat.shapes[1].geometry));
  EXPECT_TRUE(std::holds_alternative<Cylinder>(flat.shapes[2].geometry));
  EXPECT_NEAR(std::get<Cylinder>(at(flat, 0.5).shapes[2].geometry).length, 4, 1e-12);
}

/// The front of a shape stays what it is, also of one that mirrors.
TEST_F(PbrtMotion, FrontsStayInFront) {
  const std::string still = std::string("Scale -1 1 1 Rotate 90 0 0 1\n") + kTriangle,
                    moves = std::string("Scale -1 1 1\n") + at_end("Rotate 90 0 0 1") + kTriangle;
  const SceneDescription s = good_pbrt(moves);
  expect_near(front_normal(at(s, 1)), front_normal(good_pbrt(still)));
  expect_near(front_normal(s), {0, 0, 1});
}

TEST_F(PbrtMotion, ObjectsAndTheirInstancesMove) {
  const SceneDescription s = good_pbrt(
      "ObjectBegin \"o\"\n" + at_end("Translate 0 2 0") + kTriangle + "ObjectEnd\nAttributeBegin\n" +
      at_end("Rotate 90 0 0 1 Translate 2 0 0") + "ObjectInstance \"o\" AttributeEnd ObjectInstance \"o\"\n");
  const SceneDescription half = at(s, 0.5);
  expect_near(std::get<Mesh>(half.groups.at(0).shapes.at(0).geometry).positions[0], {0, 1, 0});
  expect_near_matrix(half.instances.at(0).to_world, translation({0, 1, 0}) * rotation({0, 0, 1}, 45));
  EXPECT_EQ(half.instances.at(1).to_world, glm::dmat4(1.0));
}

/// pbrt interpolates the camera's transform to the world, which is the inverse of the current one.
TEST_F(PbrtMotion, CamerasMove) {
  const SceneDescription s =
      good_pbrt(kTriangle, "Rotate 30 0 1 0\n" + at_end("Rotate 60 0 1 0 Translate 0 0 6") + kCamera);
  const glm::dmat4 mirror = scaling({-1, 1, 1});
  expect_near_matrix(s.camera.to_world, rotation({0, 1, 0}, -30) * mirror);
  expect_near_matrix(at(s, 0.5).camera.to_world, translation({0, 0, -3}) * rotation({0, 1, 0}, -60) * mirror);
  expect_near_matrix(at(s, 1).camera.to_world, translation({0, 0, -6}) * rotation({0, 1, 0}, -90) * mirror);
}

TEST_F(PbrtMotion, LensesGrowWithTheirCameras) {
  const std::string grows = at_end("Scale 0.25 0.25 0.25");
  const SceneDescription s = good_pbrt(
      kTriangle, grows + kCamera + std::string("\"float lensradius\" 0.5 \"float focaldistance\" 3"));
  EXPECT_NEAR(at(s, 0.5).camera.aperture_radius, 0.5 * 2.5, 1e-12);
  EXPECT_NEAR(at(s, 1).camera.focus_distance, 12, 1e-12);
  const SceneDescription parallel = good_pbrt(kTriangle, grows + "Camera \"orthographic\"");
  EXPECT_NEAR(at(parallel, 1).camera.scale_x / parallel.camera.scale_x, 4, 1e-12);
  EXPECT_THAT(wrong(kTriangle, at_end("Scale 1 1 3") + kCamera),
              HasSubstr("must not change its angle of view"));
}

TEST_F(PbrtMotion, LightsTexturesAndMediaStay) {
  const SceneDescription s = good_pbrt(at_end("Translate 3 0 0") +
                                       "LightSource \"point\"\nTexture \"t\" \"spectrum\" \"checkerboard\"\n"
                                       "AreaLightSource \"diffuse\"\n" +
                                       kTriangle);
  expect_near(only<PointLight>(at(s, 1)).position, {0, 0, 0});
  EXPECT_THAT(warnings(s), HasSubstr("lights do not move, as in pbrt"));
  EXPECT_THAT(warnings(s), HasSubstr("textures do not move"));
  EXPECT_THAT(warnings(s), HasSubstr("pbrt refuses them"));
  expect_near(mesh(at(s, 1)).positions[0], {3, 0, 0});
}

TEST_F(PbrtMotion, WhatDoesNotVaryDoesNotMove) {
  const SceneDescription s =
      good_pbrt(std::string("ActiveTransform StartTime Translate 1 0 0 ActiveTransform "
                            "EndTime Translate 1 0 0 ActiveTransform All\n") +
                kTriangle);
  EXPECT_EQ(s.motion, nullptr);
  EXPECT_THAT(s.warnings, IsEmpty());
}

TEST_F(PbrtMotion, WhatIsWrongIsSaid) {
  EXPECT_THAT(wrong("ActiveTransform Sometimes\n"), HasSubstr("StartTime, EndTime or All"));
  EXPECT_THAT(wrong(kTriangle, "TransformTimes 1 1 Camera \"perspective\""),
              HasSubstr("must be after the start"));
  EXPECT_THAT(wrong(kTriangle, "TransformTimes 1 0 Camera \"perspective\""),
              HasSubstr("must be after the start"));
  EXPECT_THAT(wrong(kTriangle, "TransformTimes 0 nan Camera \"perspective\""), HasSubstr("nan"));
  EXPECT_THAT(wrong(std::string("TransformTimes 0 1\n") + kTriangle), HasSubstr("before WorldBegin"));
  EXPECT_THAT(wrong(at_end("Scale 1 1 0") + kTriangle), HasSubstr("key 2: its transform is singular"));
  EXPECT_THAT(wrong(at_end("Scale 1 1 -1") + kTriangle), HasSubstr("one mirrors"));
}

}  // namespace
}  // namespace penumbra::pbrt_test
