// Animations in Mitsuba's files: keys of sensors, shapes, instances and emitters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scenes/instances.h"
#include "scenes/motion/exposure.h"
#include "scenes/motion/motion_facts.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/transform.h"
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

class MitsubaAnimations : public SceneText {
 protected:
  static void expect_near(const glm::dmat4& made, const glm::dmat4& wanted) {
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(made[i / 4][i % 4], wanted[i / 4][i % 4], 1e-12) << i;
  }
  static void expect_near(const glm::dvec3& made, const glm::dvec3& wanted, double tolerance = 1e-12) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(made[i], wanted[i], tolerance) << i;
  }
  static std::string animation(std::string_view name, std::string_view keys) {
    return "<animation name='" + std::string(name) + "'>" + std::string(keys) + "</animation>";
  }
  static std::string key(double time, std::string_view steps) {
    return "<transform time='" + std::to_string(time) + "'>" + std::string(steps) + "</transform>";
  }
  static std::string sensor(double open, std::string_view more = "") {
    return "<sensor type='perspective'><float name='shutter_open' value='" + std::to_string(open) + "'/>" +
           std::string(more) + "</sensor>";
  }
  static std::string group(std::string_view inside) {
    return "<shape type='shapegroup' id='g'>" + std::string(inside) + "</shape>";
  }
  /// Where the group's origin is when the shutter opens.
  glm::dvec3 place(double open, std::string_view keys) {
    const SceneDescription s = good(sensor(open) + group(in("shape", "sphere")) +
                                    in("shape", "instance", "<ref id='g'/>" + animation("animation", keys)));
    EXPECT_THAT(s.warnings, ::testing::Contains(HasSubstr("the scene moves; it is shown as at")));
    return s.instances.size() == 1 ? glm::dvec3(s.instances[0].to_world[3]) : glm::dvec3(1e9);
  }
  SceneDescription at(const SceneDescription& scene, double time) {
    SceneDescription moved = scene;
    const auto done = set_time(moved, time);
    EXPECT_TRUE(done) << done.error().message;
    return moved;
  }
  /// A shape of a scene with these keys is, at the time, what a still with the transform that they have then
  /// gives.
  void expect_still(std::string_view type, std::string_view inside, std::span<const TransformKey> keys,
                    std::initializer_list<double> times) {
    SCOPED_TRACE(std::string(type) + " " + std::string(inside));
    const auto matrix = [](const glm::dmat4& m) {
      std::string text;
      for (int i = 0; i < 16; ++i) text += digits(m[i % 4][i / 4]) + " ";
      return "<matrix value='" + text + "'/>";
    };
    std::string all;
    for (const auto& [time, transform] : keys) all += key(time, matrix(transform));
    const SceneDescription scene =
        good(sensor(0.25) + in("shape", type, std::string(inside) + animation("to_world", all)));
    const auto parts = keyed_transform(keys);
    ASSERT_TRUE(parts) << parts.error().message;
    for (const double time : times) {
      SCOPED_TRACE(time);
      const SceneDescription still =
          good(in("shape", type, std::string(inside) + to_world(matrix(transform_at(*parts, time)))));
      ASSERT_EQ(still.shapes.size(), 1u);
      expect_same(at(scene, time).shapes.at(0), still.shapes[0]);
    }
  }
  static std::string digits(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
  }
  static void expect_same(const Shape& made, const Shape& wanted) {
    EXPECT_EQ(made.flip_normals, wanted.flip_normals);
    ASSERT_EQ(made.geometry.index(), wanted.geometry.index());
    if (const auto* sphere = std::get_if<Sphere>(&wanted.geometry)) {
      const auto& other = std::get<Sphere>(made.geometry);
      expect_near(other.center, sphere->center);
      EXPECT_NEAR(other.radius, sphere->radius, 1e-12);
      expect_near(other.x_axis, sphere->x_axis);
      expect_near(other.y_axis, sphere->y_axis);
      expect_near(other.z_axis, sphere->z_axis);
    } else if (const auto* disk = std::get_if<Disk>(&wanted.geometry)) {
      const auto& other = std::get<Disk>(made.geometry);
      expect_near(other.center, disk->center);
      expect_near(other.normal, disk->normal);
      EXPECT_NEAR(other.radius, disk->radius, 1e-12);
      expect_near(other.x_axis, disk->x_axis);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&wanted.geometry)) {
      const auto& other = std::get<Cylinder>(made.geometry);
      expect_near(other.center, cylinder->center);
      expect_near(other.axis, cylinder->axis);
      EXPECT_NEAR(other.radius, cylinder->radius, 1e-12);
      EXPECT_NEAR(other.length, cylinder->length, 1e-12);
      expect_near(other.x_axis, cylinder->x_axis);
      expect_near(other.y_axis, cylinder->y_axis);
    } else {
      const auto &other = std::get<Mesh>(made.geometry), &mesh = std::get<Mesh>(wanted.geometry);
      EXPECT_EQ(other.triangles, mesh.triangles);
      ASSERT_EQ(other.positions.size(), mesh.positions.size());
      ASSERT_EQ(other.normals.size(), mesh.normals.size());
      for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        expect_near(other.positions[i], mesh.positions[i]);
      for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        expect_near(glm::dvec3(other.normals[i]), glm::dvec3(mesh.normals[i]), 1e-6);  // single precision
    }
  }
};

constexpr std::string_view kAnimationKeys =
    "<transform time='1'><translate x='2'/></transform><transform time='3'><translate x='6' "
    "y='4'/></transform>";

TEST_F(MitsubaAnimations, AreShownWhenTheShutterOpens) {
  EXPECT_EQ(place(0, kAnimationKeys), glm::dvec3(2, 0, 0));  // before the first key
  EXPECT_EQ(place(1, kAnimationKeys), glm::dvec3(2, 0, 0));
  EXPECT_EQ(place(1.5, kAnimationKeys), glm::dvec3(3, 1, 0));
  EXPECT_EQ(place(3, kAnimationKeys), glm::dvec3(6, 4, 0));
  EXPECT_EQ(place(7, kAnimationKeys), glm::dvec3(6, 4, 0));
}

TEST_F(MitsubaAnimations, AreBlurredWhileTheShutterIsOpen) {
  const auto read = [&](std::string_view close) {
    return good(sensor(1.5, "<float name='shutter_close' value='" + std::string(close) + "'/>") +
                in("shape", "sphere", in("emitter", "area") + animation("to_world", kAnimationKeys)));
  };
  const SceneDescription blurred = read("2.25"), still = read("1.5");
  EXPECT_THAT(blurred.warnings, ::testing::IsEmpty());
  EXPECT_EQ(exposure_of(blurred).open, 1.5);
  EXPECT_EQ(exposure_of(blurred).close, 2.25);
  EXPECT_THAT(still.warnings, ::testing::ElementsAre(HasSubstr("it is shown as at 1.5 s")));
  EXPECT_EQ(exposure_of(still).close, 1.5);
  // Another time moves the exposure.
  EXPECT_EQ(exposure_of(at(blurred, 3)).open, 3);
  EXPECT_EQ(exposure_of(at(blurred, 3)).close, 3.75);
}

TEST_F(MitsubaAnimations, RotationsTurnEvenlyAndStretchesGrow) {
  const glm::dmat4 from = rotation({0, 0, 1}, -75) * scaling({1, 2, 3}),
                   to = rotation({0, 0, 1}, 75) * scaling({3, 2, 1});
  const auto turn = keyed_transform(std::vector<TransformKey>{{0, from}, {1, to}});
  ASSERT_TRUE(turn);
  // 150 degrees in a unit of time.
  expect_near(transform_at(*turn, 0.23), rotation({0, 0, 1}, -75 + 150 * 0.23) * scaling({1.46, 2, 2.54}));
  expect_near(transform_at(*turn, 0.0), from);
  // A mirror stays one on both sides.
  const auto mirrors = keyed_transform(
      std::vector<TransformKey>{{0, scaling({-1, 1, 1})}, {1, translation({2, 0, 0}) * scaling({-1, 1, 1})}});
  ASSERT_TRUE(mirrors);
  expect_near(transform_at(*mirrors, 0.5), translation({1, 0, 0}) * scaling({-1, 1, 1}));
}

/// Of matrices that shear. The numbers are those of scipy 1.17.1: linalg.polar, the sign of both parts
/// changed where the matrix mirrors, and spatial.transform.Slerp.
TEST_F(MitsubaAnimations, MatricesAreInterpolatedByTheirPolarParts) {
  const auto rows = [](std::initializer_list<double> n) { return *matrix_from_rows(std::vector<double>(n)); };
  const glm::dmat4 a = rows({1.1, -0.3, 0.2, 1, 0.4, 0.9, -0.5, -2, 0.1, 0.6, 1.4, 3.5, 0, 0, 0, 1}),
                   b = rows({-0.2, -1.5, 0.3, 4, 1.2, 0.1, 0.7, 0, -0.6, 0.2, 2.1, -1.5, 0, 0, 0, 1});
  const auto keys = keyed_transform(std::vector<TransformKey>{{2, a}, {4, b}});
  ASSERT_TRUE(keys);
  expect_near(transform_at(*keys, 2.5),
              rows({0.923144479449388, -0.6393919522184321, 0.33213763746346275, 1.75, 0.7932015416529865,
                    0.9166694826302119, -0.3189633655021747, -1.5, -0.011921135190575496, 0.4878255479042443,
                    1.616180589497404, 2.25, 0, 0, 0, 1}));
  expect_near(transform_at(*keys, 3.4),
              rows({0.3060753360363365, -1.2407427727289564, 0.42694172645143813, 3.1, 1.2159076738937917,
                    0.575647014936268, 0.2310226875865826, -0.6, -0.3387827176955078, 0.2834009759111226,
                    1.9514438616188408, 0, 0, 0, 0, 1}));
  const glm::dmat4 mirror = scaling({1, -1, 1});
  const auto mirrored = keyed_transform(std::vector<TransformKey>{{0, a * mirror}, {1, b * mirror}});
  ASSERT_TRUE(mirrored);
  expect_near(transform_at(*mirrored, 0.4),
              rows({0.7523942691998284, 0.8518599066981064, 0.3917957756852895, 2.2, 0.9845879971925457,
                    -0.8575137853721958, -0.16521642470929634, -1.2, -0.10591362842238979,
                    -0.41577113674489596, 1.738746187928425, 1.5, 0, 0, 0, 1}));
}

TEST_F(MitsubaAnimations, ShapesThatMoveAreThoseOfStills) {
  write("bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  const std::string bent = "<string name='filename' value='bent.obj'/>",
                    faceted = bent + "<boolean name='face_normals' value='true'/>";
  const auto turned = [](double degrees) { return rotation({1, 2, 3}, degrees); };
  const std::vector<TransformKey> rigid = {
      {0, translation({1, 2, 3}) * turned(20)}, {1, translation({-1, 0, 5}) * turned(130)}, {3, turned(10)}};
  const std::vector<TransformKey> mirrored = {{0, turned(20) * scaling({-2, 2, 2})},
                                              {1, turned(-50) * scaling({-3, 3, 3})}};
  const std::vector<TransformKey> stretched = {{0, turned(20) * scaling({1, 1, 3})},
                                               {1, translation({1, 0, 0}) * turned(70) * scaling({2, 2, 1})}};
  const std::vector<TransformKey> askew = {{0, turned(20) * scaling({1, 4, 3})},
                                           {1, turned(70) * scaling({2, -1, -1})}};
  for (const auto* keys : {&rigid, &mirrored}) {
    expect_still("sphere", "<point name='center' x='1' y='0' z='0'/>", *keys,
                 {-1, 0, 0.25, 0.5, 0.9, 2.5, 4});
    expect_still("disk", "", *keys, {0, 0.3, 0.6, 2});
    expect_still("cylinder", "<float name='radius' value='0.3'/>", *keys, {0, 0.3, 0.6, 2});
  }
  expect_still("disk", "", stretched, {0, 0.3, 0.6, 1});
  expect_still("cylinder", "<point name='p0' x='0' y='0' z='1'/><point name='p1' x='0' y='0' z='2'/>",
               stretched, {0, 0.3, 0.6, 1});
  for (const auto* keys : {&rigid, &mirrored, &stretched, &askew}) {
    expect_still("rectangle", "", *keys, {0, 0.3, 0.6, 1});
    expect_still("cube", "<boolean name='flip_normals' value='true'/>", *keys, {0, 0.3, 0.6, 1});
    expect_still("obj", bent, *keys, {0, 0.3, 0.6, 1});
    expect_still("obj", faceted, *keys, {0, 0.3, 0.6, 1});
  }
}

/// An ellipse at one key is a polygon at all times.
TEST_F(MitsubaAnimations, DisksThatBecomeEllipsesArePolygons) {
  const SceneDescription s =
      good(in("shape", "disk", animation("to_world", key(0, "") + key(1, "<scale x='2' y='3'/>"))));
  const auto area = [](const SceneDescription& scene) {
    double sum = 0;
    const Mesh& mesh = std::get<Mesh>(scene.shapes.at(0).geometry);
    for (const glm::uvec3& t : mesh.triangles)
      sum += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                          mesh.positions[t.z] - mesh.positions[t.x]));
    return sum;
  };
  EXPECT_NEAR(area(s), M_PI, 1e-9);
  EXPECT_NEAR(area(at(s, 0.5)), M_PI * 1.5 * 2, 1e-9);
}

TEST_F(MitsubaAnimations, CamerasAndLightsMove) {
  const std::string turn =
      animation("toWorld", key(0, "") + key(2, "<rotate y='1' angle='90'/><translate x='4'/>"));
  write("sky.pfm", "PF\n2 2\n-1.0\n" + std::string(48, '\0'));
  const SceneDescription s =
      good("<sensor type='perspective'>" + turn + "</sensor>" +
           in("shape", "rectangle", in("emitter", "area") + turn) + in("emitter", "point", turn) +
           in("emitter", "spot", turn) + in("emitter", "directional", turn) +
           in("emitter", "projector", turn + "<float name='fov' value='30'/>") +
           in("emitter", "envmap", turn + "<string name='filename' value='sky.pfm'/>"));
  ASSERT_NE(s.motion, nullptr);
  EXPECT_EQ(time_range(*s.motion), std::pair(0.0, 2.0));
  const SceneDescription half = at(s, 1);
  const glm::dmat4 wanted = translation({2, 0, 0}) * rotation({0, 1, 0}, 45);
  expect_near(half.camera.to_world, wanted);
  expect_near(only<PointLight>(half).position, {2, 0, 0});
  expect_near(only<SpotLight>(half).to_world, wanted);
  expect_near(only<ProjectorLight>(half).to_world, wanted);
  expect_near(only<EnvironmentMapLight>(half).to_world, wanted);
  expect_near(only<DirectionalLight>(half).direction, {std::sqrt(0.5), 0, std::sqrt(0.5)});
  expect_near(std::get<Mesh>(half.shapes.at(0).geometry).positions[0], transform_point(wanted, {-1, -1, 0}));
  EXPECT_TRUE(emits(half.shapes[0]));
  // The time asked for needs no warning.
  ReadOptions options;
  options.time = 2.0;
  const SceneDescription last = good("<sensor type='perspective'>" + turn + "</sensor>", options);
  EXPECT_THAT(last.warnings, IsEmpty());
  EXPECT_EQ(last.time, 2.0);
  expect_near(last.camera.to_world, translation({4, 0, 0}) * rotation({0, 1, 0}, 90));
}

TEST_F(MitsubaAnimations, OrthographicViewsGrow) {
  const SceneDescription s = good("<sensor type='orthographic'>" +
                                  animation("to_world", key(0, "<scale x='2' y='4' z='3'/>") +
                                                            key(1,
                                                                "<scale x='4' y='4' z='3'/><rotate z='1' "
                                                                "angle='90'/>")) +
                                  "</sensor>");
  EXPECT_NEAR(s.camera.scale_x, 2, 1e-12);
  const SceneDescription half = at(s, 0.5);
  EXPECT_NEAR(half.camera.scale_x, 3, 1e-12);
  EXPECT_NEAR(half.camera.scale_y, 4, 1e-12);
  expect_near(half.camera.to_world, rotation({0, 0, 1}, 45));
}

TEST_F(MitsubaAnimations, ShapesOfGroupsAndTheirInstancesMove) {
  const std::string moves = animation("to_world", key(0, "") + key(1, "<translate y='2'/>"));
  const SceneDescription s =
      good(group(in("shape", "sphere", moves)) + in("shape", "instance", "<ref id='g'/>" + moves) +
           in("shape", "instance", "<ref id='g'/>"));
  const SceneDescription half = at(s, 0.5);
  expect_near(std::get<Sphere>(half.groups.at(0).shapes.at(0).geometry).center, {0, 1, 0});
  expect_near(half.instances.at(0).to_world, translation({0, 1, 0}));
  EXPECT_EQ(half.instances.at(1).to_world, glm::dmat4(1.0));
  EXPECT_EQ(moving_instances(s), (std::vector<bool>{true, true}));
}

TEST_F(MitsubaAnimations, WhatMovesIsCounted) {
  const std::string moves = animation("to_world", kAnimationKeys);
  const SceneDescription s =
      good("<sensor type='orthographic'>" + animation("to_world", key(0, "") + key(1, "<scale x='2'/>")) +
           "</sensor>" + group(in("shape", "sphere", moves) + in("shape", "cube")) +
           in("shape", "instance", "<ref id='g'/>" + moves) + in("shape", "instance", "<ref id='g'/>") +
           in("shape", "cube", moves) + in("shape", "cube") + in("emitter", "point", moves) +
           in("emitter", "spot"));
  const auto facts = motion_facts(s);
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->shapes.moving, 2u);
  EXPECT_EQ(facts->shapes.all, 4u);
  EXPECT_EQ(facts->instances.moving, 1u);
  EXPECT_EQ(facts->instances.all, 2u);
  EXPECT_EQ(facts->emitters.moving, 1u);
  EXPECT_EQ(facts->emitters.all, 2u);
  EXPECT_EQ(facts->meshes_that_deform, 0u);
  EXPECT_TRUE(facts->camera);
  EXPECT_THAT(facts->camera_numbers, ElementsAre("scale_x"));
  EXPECT_EQ(facts->times, std::pair(0.0, 3.0));
  EXPECT_FALSE(motion_facts(good(in("shape", "cube"))));
}

TEST(FramesBetween, AreWholeFramesOfTheTimes) {
  using Frames = std::pair<std::int64_t, std::int64_t>;
  EXPECT_EQ(frames_between({0, 2.5}, 24), Frames(0, 60));
  EXPECT_EQ(frames_between({0.5, 0.9}, 10), Frames(5, 9));
  EXPECT_EQ(frames_between({0.51, 0.89}, 10), Frames(6, 8));
  EXPECT_EQ(frames_between({-1, double(1.0f / 24 * 31)}, 24), Frames(-24, 31));
  EXPECT_EQ(frames_between({0.51, 0.59}, 10), std::nullopt);
  EXPECT_EQ(frames_between({0, 1e30}, 24), std::nullopt);
}

TEST_F(MitsubaAnimations, WhatDoesNotVaryDoesNotMove) {
  const std::string same = key(0, "<translate x='2'/>") + key(5, "<translate x='2'/>");
  for (const std::string& keys : {same, key(3, "<translate x='2'/>")}) {
    const SceneDescription s = good(in("emitter", "point", animation("to_world", keys)));
    EXPECT_EQ(s.motion, nullptr);
    EXPECT_THAT(s.warnings, ::testing::Not(::testing::Contains(HasSubstr("moves"))));
    EXPECT_EQ(only<PointLight>(s).position, glm::dvec3(2, 0, 0));
  }
  // Nor does a camera that is not used, or what has no place.
  EXPECT_EQ(good(sensor(0) + sensor(0, animation("to_world", kAnimationKeys)) +
                 in("emitter", "constant", animation("to_world", kAnimationKeys)))
                .motion,
            nullptr);
}

TEST_F(MitsubaAnimations, KeysThatAreAlmostEqualAreKeys) {
  const SceneDescription s =
      good(in("emitter", "point",
              animation("to_world",
                        "<transform time='1'/><transform time='1.0000000000000002'><translate "
                        "x='1'/></transform>")));
  EXPECT_EQ(only<PointLight>(at(s, 1)).position, glm::dvec3(0.0));
  expect_near(only<PointLight>(at(s, std::nextafter(1.0, 2.0))).position, {1, 0, 0});
}

TEST_F(MitsubaAnimations, WhatStaysIsSaid) {
  const std::string turn = animation("to_uv", key(0, "") + key(1, "<rotate z='1' angle='90'/>")),
                    moves = animation("to_world", kAnimationKeys);
  EXPECT_THAT(
      warnings(good(in(
          "shape", "sphere",
          in("bsdf", "diffuse", "<texture type='checkerboard' name='reflectance'>" + turn + "</texture>")))),
      HasSubstr("the to_uv of a texture is as at 0 s"));
  EXPECT_THAT(warnings(good(group(in("shape", "sphere")) + "<shape type='shapegroup' id='h'>" +
                            in("shape", "instance", "<ref id='g'/>" + moves) + "</shape>" +
                            in("shape", "instance", "<ref id='h'/>"))),
              HasSubstr("an instance within a group does not move"));
}

TEST_F(MitsubaAnimations, WhatIsWrongIsSaid) {
  const auto wrong = [&](std::string_view keys) {
    return error(scene(in("emitter", "point", animation("to_world", keys))));
  };
  EXPECT_THAT(wrong(""), HasSubstr("holds at least one"));
  EXPECT_THAT(wrong("<transform time='1'/><transform time='1'/>"), HasSubstr("must ascend; 1 follows 1"));
  EXPECT_THAT(wrong("<transform time='1'/><transform time='0'/>"), HasSubstr("must ascend; 0 follows 1"));
  EXPECT_THAT(wrong("<transform time='nan'/>"), HasSubstr("nan"));
  EXPECT_THAT(wrong("<transform/>"), HasSubstr("time"));
  EXPECT_THAT(wrong("<float name='a' value='1'/>"), HasSubstr("no <float>"));
  EXPECT_THAT(wrong("<transform time='0'><scale x='0'/></transform>"), HasSubstr("singular"));
  // Turned inside out between two keys.
  EXPECT_THAT(wrong("<transform time='0'/><transform time='1'><scale x='-1'/></transform>"),
              HasSubstr("keys 1 and 2: one mirrors"));
  const auto wrong_of = [&](std::string_view tag, std::string_view type) {
    return error(scene(in(tag, type,
                          animation("to_world", key(0, "") + key(1,
                                                                 "<scale x='2'/><rotate z='1' "
                                                                 "angle='45'/><scale x='2'/>")))));
  };
  EXPECT_THAT(wrong_of("shape", "sphere"), HasSubstr("must scale all directions alike"));
  EXPECT_THAT(wrong_of("shape", "cylinder"), HasSubstr("must scale all directions across"));
  EXPECT_THAT(wrong_of("sensor", "perspective"), HasSubstr("at 1 s the transform shears"));
}

}  // namespace
}  // namespace penumbra
