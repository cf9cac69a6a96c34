// Scenes that move, written as Mitsuba files and read again.
#include <gmock/gmock.h>

#include <cmath>

#include "scenes/mitsuba/written_motion.h"
#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/settings.h"
#include "scenes/transform.h"
#include "tests/scenes/gltf_motion.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/scenes/pbrt_text.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

using ::testing::Contains;
using ::testing::Not;

class WrittenMotion : public pbrt_test::PbrtText {
 protected:
  static constexpr double kSame = 1e-9;

  SceneDescription again(const SceneDescription& scene) {
    remarks_.clear();
    const auto files = mitsuba::scene_files(scene, folder_ / "written.xml", &remarks_);
    EXPECT_TRUE(files) << files.error().message;
    if (files)
      for (const mitsuba::SceneFile& file : *files) write_text(file.path, file.contents);
    return good_of(read_scene(folder_ / "written.xml", {}));
  }
  static SceneDescription at(const SceneDescription& scene, double time) {
    SceneDescription moved = scene;
    const auto done = set_time(moved, time);
    EXPECT_TRUE(done) << done.error().message;
    return moved;
  }
  static void expect_matrix(const glm::dmat4& made, const glm::dmat4& wanted, double tolerance = kSame) {
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(made[i / 4][i % 4], wanted[i / 4][i % 4], tolerance) << i;
  }
  static void expect_point(const glm::dvec3& made, const glm::dvec3& wanted, double tolerance = kSame) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(made[i], wanted[i], tolerance) << i;
  }
  static void expect_shape(const Shape& made, const Shape& wanted, double tolerance) {
    SCOPED_TRACE(wanted.name);
    EXPECT_EQ(made.flip_normals, wanted.flip_normals);
    ASSERT_EQ(made.geometry.index(), wanted.geometry.index());
    if (const auto* sphere = std::get_if<Sphere>(&wanted.geometry)) {
      const auto& other = std::get<Sphere>(made.geometry);
      expect_point(other.center, sphere->center, tolerance);
      EXPECT_NEAR(other.radius, sphere->radius, tolerance);
      expect_point(other.x_axis, sphere->x_axis, tolerance);
      expect_point(other.z_axis, sphere->z_axis, tolerance);
    } else if (const auto* disk = std::get_if<Disk>(&wanted.geometry)) {
      const auto& other = std::get<Disk>(made.geometry);
      expect_point(other.center, disk->center, tolerance);
      expect_point(other.normal, disk->normal, tolerance);
      EXPECT_NEAR(other.radius, disk->radius, tolerance);
      expect_point(other.x_axis, disk->x_axis, tolerance);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&wanted.geometry)) {
      const auto& other = std::get<Cylinder>(made.geometry);
      expect_point(other.center, cylinder->center, tolerance);
      expect_point(other.axis, cylinder->axis, tolerance);
      EXPECT_NEAR(other.radius, cylinder->radius, tolerance);
      EXPECT_NEAR(other.length, cylinder->length, tolerance);
      expect_point(other.x_axis, cylinder->x_axis, tolerance);
    } else {
      const auto &other = std::get<Mesh>(made.geometry), &mesh = std::get<Mesh>(wanted.geometry);
      EXPECT_EQ(other.triangles, mesh.triangles);
      ASSERT_EQ(other.positions.size(), mesh.positions.size());
      ASSERT_EQ(other.normals.size(), mesh.normals.size());
      for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        expect_point(other.positions[i], mesh.positions[i], tolerance);
      for (std::size_t i = 0; i < mesh.normals.size(); ++i)  // which are in single precision
        expect_point(glm::dvec3(other.normals[i]), glm::dvec3(mesh.normals[i]), std::max(tolerance, 1e-6));
    }
  }
  /// At each of the times all that moves is where it was.
  void expect_same(const SceneDescription& scene, std::initializer_list<double> times,
                   double tolerance = kSame) {
    const SceneDescription written = again(scene);
    EXPECT_EQ(written.time, scene.time);
    for (const double time : times) {
      SCOPED_TRACE(time);
      const SceneDescription before = at(scene, time), after = at(written, time);
      expect_matrix(after.camera.to_world, before.camera.to_world, tolerance);
      EXPECT_NEAR(after.camera.scale_x, before.camera.scale_x, tolerance);
      EXPECT_NEAR(after.camera.scale_y, before.camera.scale_y, tolerance);
      ASSERT_EQ(after.instances.size(), before.instances.size());
      for (std::size_t i = 0; i < before.instances.size(); ++i)
        expect_matrix(after.instances[i].to_world, before.instances[i].to_world, tolerance);
      ASSERT_EQ(after.shapes.size(), before.shapes.size());
      for (std::size_t i = 0; i < before.shapes.size(); ++i)
        expect_shape(after.shapes[i], before.shapes[i], tolerance);
      ASSERT_EQ(after.groups.size(), before.groups.size());
      for (std::size_t g = 0; g < before.groups.size(); ++g)
        for (std::size_t i = 0; i < before.groups[g].shapes.size(); ++i)
          expect_shape(after.groups[g].shapes.at(i), before.groups[g].shapes[i], tolerance);
      ASSERT_EQ(after.emitters.size(), before.emitters.size());
      for (std::size_t i = 0; i < before.emitters.size(); ++i)
        expect_emitter(after.emitters[i], before.emitters[i], tolerance);
    }
  }
  static void expect_emitter(const Emitter& made, const Emitter& wanted, double tolerance) {
    ASSERT_EQ(made.index(), wanted.index());
    const auto axes = [](const glm::dmat4& m) { return *without_scale(m); };
    if (const auto* point = std::get_if<PointLight>(&wanted))
      expect_point(std::get<PointLight>(made).position, point->position, tolerance);
    if (const auto* sun = std::get_if<DirectionalLight>(&wanted))
      expect_point(glm::normalize(std::get<DirectionalLight>(made).direction), glm::normalize(sun->direction),
                   tolerance);
    if (const auto* spot = std::get_if<SpotLight>(&wanted))
      expect_matrix(axes(std::get<SpotLight>(made).to_world), axes(spot->to_world), tolerance);
    if (const auto* map = std::get_if<EnvironmentMapLight>(&wanted))
      expect_matrix(axes(std::get<EnvironmentMapLight>(made).to_world), axes(map->to_world), tolerance);
    if (const auto* projector = std::get_if<ProjectorLight>(&wanted))
      expect_matrix(axes(std::get<ProjectorLight>(made).to_world), axes(projector->to_world), tolerance);
  }

  static std::string moves(double factor = 1.0) {
    const std::string scale = "<scale value='" + std::to_string(factor) + "'/>";
    return "<animation name='to_world'><transform time='0'>" + scale +
           "<rotate x='1' y='2' z='0.5' angle='30'/><translate x='1' y='2'/></transform><transform "
           "time='0.4'>" +
           scale + "<scale value='1.3'/>" +
           "<rotate y='1' angle='100'/><translate z='3'/></transform><transform time='2'>" + scale +
           "<translate x='-4'/></transform></animation>";
  }

  std::vector<std::string> remarks_;
};

class WrittenGltfMotion : public GltfMotion {
 protected:
  SceneDescription again(const SceneDescription& scene) {
    remarks_.clear();
    const auto files = mitsuba::scene_files(scene, folder_ / "written.xml", &remarks_);
    EXPECT_TRUE(files) << files.error().message;
    if (files)
      for (const mitsuba::SceneFile& file : *files) write_text(file.path, file.contents);
    return good_of(read_scene(folder_ / "written.xml", {}));
  }
  std::vector<std::string> remarks_;
};

TEST_F(WrittenMotion, OfMitsubaStaysTheSame) {
  write("sky.pfm", "PF\n2 2\n-1.0\n" + std::string(48, '\0'));
  write("bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  const std::string bent = "<string name='filename' value='bent.obj'/>";
  const SceneDescription scene =
      good("<sensor type='perspective'><float name='shutter_open' value='0.3'/>" + moves() + "</sensor>" +
           in("shape", "sphere", "<point name='center' x='2' y='1' z='0'/>" + moves(2)) +
           in("shape", "sphere", moves(-1.5)) + in("shape", "disk", moves(2)) +
           in("shape", "cylinder",
              "<point name='p0' x='1' y='0' z='0'/><point name='p1' x='2' y='1' z='0'/><float name='radius' "
              "value='0.2'/>" +
                  moves(2)) +
           in("shape", "rectangle", in("emitter", "area") + moves(-2)) + in("shape", "cube", moves(3)) +
           in("shape", "obj", bent + moves(-1.3)) +
           in("shape", "obj", bent + "<boolean name='face_normals' value='true'/>" + moves(-1.3)) +
           "<shape type='shapegroup' id='g'>" + in("shape", "sphere", moves()) + in("shape", "cube") +
           "</shape>" + in("shape", "instance", "<ref id='g'/>" + moves(1.7)) +
           in("shape", "instance", "<ref id='g'/>") + in("emitter", "point", moves(2)) +
           in("emitter", "spot", moves(2)) + in("emitter", "directional", moves()) +
           in("emitter", "projector", moves() + "<float name='fov' value='30'/>") +
           in("emitter", "envmap", moves(-1) + "<string name='filename' value='sky.pfm'/>"));
  expect_same(scene, {-1, 0, 0.15, 0.3, 0.4, 1.1, 2, 5});
  EXPECT_THAT(remarks_, Contains(HasSubstr("Mitsuba 3 has no <animation>")));
  EXPECT_THAT(remarks_, Not(Contains(HasSubstr("approximate"))));
}

TEST_F(WrittenMotion, TheExposureStaysTheSame) {
  const std::string sphere = in("shape", "sphere", in("emitter", "area") + moves());
  struct Given {
    double open, close;
    std::vector<std::pair<const char*, const char*>> settings;
  };
  const Given given[] = {{0, 0, {}},
                         {0.25, 0.75, {}},
                         {0.25, 0.75, {{"camera.shutter", "0"}}},
                         {0.5, 0.5, {{"camera.shutter", "0.5"}, {"camera.shutter_position", "center"}}},
                         {0.5,
                          0.75,
                          {{"camera.shutter_curve", "triangle"},
                           {"camera.rolling_shutter", "0.25"},
                           {"camera.shutter_position", "end"}}}};
  for (const auto& [open, close, settings] : given) {
    SceneDescription scene =
        good("<sensor type='perspective'><float name='shutter_open' value='" + std::to_string(open) +
             "'/><float name='shutter_close' value='" + std::to_string(close) + "'/></sensor>" + sphere);
    for (const auto& [key, value] : settings) ASSERT_TRUE(apply_setting(scene, key, value)) << key;
    const Exposure before = exposure_of(scene), after = exposure_of(again(scene));
    // A few roundings of times below 1, and of their quotients by some 0.01.
    constexpr double kRounding = 1e-15, kShareRounding = 1e-13;
    EXPECT_NEAR(after.open, before.open, kRounding);
    EXPECT_NEAR(after.close, before.close, kRounding);
    EXPECT_NEAR(after.exposure, before.exposure, kShareRounding);
    EXPECT_NEAR(after.rolling, before.rolling, kShareRounding);
    EXPECT_EQ(after.curve, before.curve);
    const auto refused = Contains(HasSubstr("has no 'rolling_shutter'"));
    if (before.rolling > 0)
      EXPECT_THAT(remarks_, refused);
    else
      EXPECT_THAT(remarks_, Not(refused));
  }
}

TEST_F(WrittenMotion, StretchesStayTheSame) {
  const std::string stretch =
      "<animation name='to_world'><transform time='0'><scale x='2' y='3' z='4'/><rotate x='1' y='1' "
      "angle='40'/></transform><transform time='1'><rotate z='1' angle='60'/><scale x='5' y='2' "
      "z='1'/><translate x='3'/></transform></animation>";
  write("bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  expect_same(good(in("shape", "obj", "<string name='filename' value='bent.obj'/>" + stretch) +
                   in("shape", "disk", stretch)),
              {0, 0.2, 0.5, 0.7, 1});
  EXPECT_THAT(remarks_, Not(Contains(HasSubstr("approximate"))));
  expect_same(good("<sensor type='orthographic'><animation name='to_world'><transform time='0'><scale x='2' "
                   "y='3'/></transform><transform time='1'><scale x='4' y='2'/><rotate y='1' "
                   "angle='50'/></transform></animation></sensor>"),
              {0, 0.2, 0.5, 0.7, 1});
}

TEST_F(WrittenMotion, OfPbrtStaysTheSame) {
  const std::string end = "ActiveTransform EndTime Rotate 50 1 2 3 Translate 2 0 1 ActiveTransform All\n";
  expect_same(good_pbrt("Translate 1 2 3 Rotate 20 0 1 0 " + end + kTriangle +
                            "Shape \"sphere\" Shape \"cylinder\" Shape \"disk\"\n"
                            "Scale -1 1 1 " +
                            kTriangle + "ObjectBegin \"o\" " + kTriangle + "ObjectEnd ObjectInstance \"o\"\n",
                        "TransformTimes 0.5 1 LookAt 0 0 5 0 0 0 0 1 0 " + end + "Camera \"perspective\""),
              {0, 0.5, 0.6, 0.8, 1});
  EXPECT_THAT(remarks_, Not(Contains(HasSubstr("approximate"))));
}

/// Mitsuba's groups have no emitters, so that those of instances become shapes of their own.
TEST_F(WrittenMotion, EmittersOfInstancesMove) {
  const SceneDescription scene =
      good("<shape type='shapegroup' id='g'>" + in("shape", "rectangle", in("emitter", "area") + moves()) +
           in("shape", "sphere", in("emitter", "area")) + "</shape>" +
           in("shape", "instance", "<ref id='g'/>" + moves()));
  const SceneDescription written = again(scene);
  ASSERT_EQ(written.shapes.size(), 2u);
  for (const double time : {0.0, 0.2, 0.4, 1.0, 2.0}) {
    const auto flat = without_instances(at(scene, time));
    ASSERT_TRUE(flat);
    // A product of two turns is none whose parts grow evenly.
    expect_shape(at(written, time).shapes[0], flat->shapes[0], 1e-2);
    expect_shape(at(written, time).shapes[1], flat->shapes[1], kSame);
  }
  EXPECT_THAT(remarks_, Contains(HasSubstr("the motion of the shape")));
}

/// A turn about a point that moves: keys between those of the file.
TEST_F(WrittenMotion, ChainsAreSampled) {
  SceneDescription scene = good(in("shape", "rectangle", moves()));
  SceneMotion motion = *scene.motion;
  const auto turns = keyed_transform(std::vector<TransformKey>{
      {0, glm::dmat4(1.0)}, {1, translation({1, 0, 0}) * rotation({0, 0, 1}, 170)}});
  motion.nodes.push_back({.parent = 0, .keys = *turns});
  motion.shapes[0].place.node = 1;
  scene.motion = std::make_shared<const SceneMotion>(motion);
  expect_same(scene, {0, 0.1, 0.4, 0.77, 1}, 1e-3);
  EXPECT_THAT(remarks_, Contains(HasSubstr("is approximate")));
}

TEST_F(WrittenMotion, WhatHasNoKeysIsAsAtTheTime) {
  SceneDescription scene = good(in("shape", "rectangle", moves()) + in("emitter", "point", moves()));
  SceneMotion motion = *scene.motion;
  motion.emitters[0].strength = KeyedValue<double>{.times = {0, 1}, .values = {1, 3}};
  motion.shapes[0].deformation = std::make_shared<const MeshDeformation>();
  motion.camera = MovingCamera{.fov = KeyedValue<double>{.times = {0, 1}, .values = {30, 50}}};
  scene.motion = std::make_shared<const SceneMotion>(motion);
  const SceneDescription now = at(scene, 0.5), written = again(now);
  EXPECT_NEAR(written.camera.fov, 40, 1e-12);
  EXPECT_EQ(only<PointLight>(written).intensity, glm::vec3(2.0f));
  expect_shape(written.shapes.at(0), now.shapes.at(0), kSame);
  EXPECT_THAT(remarks_, Contains(HasSubstr("deforms; it is as at 0.5 s")));
  EXPECT_THAT(remarks_, Contains(HasSubstr("strength of an emitter 'point' is that at 0.5 s")));
  EXPECT_THAT(remarks_, Contains(HasSubstr("angle of view, focus and aperture are as at 0.5 s")));
}

/// Splines have keys between their own, and what deforms or vanishes at a key is as at the time.
TEST_F(WrittenGltfMotion, IsThatOfGltf) {
  const auto vertices = [&](const std::vector<Channel>& channels, GltfFile& file, double tolerance) {
    SceneDescription scene = good_gltf(file.text(moving(channels))), written = again(scene);
    for (const double time : {-1.0, 0.0, 0.4, 1.3, 2.0})
      for (const std::size_t i : {0u, 1u, 2u})
        GltfMotion::expect_near(vertex(written, time, i), vertex(scene, time, i), tolerance);
  };
  const std::vector<float> places = {0, 0, 0, 1, 2, 3, -1, 0, 2};
  GltfFile linear = triangle();
  vertices({{of_node(0, "translation"), vectors(linear, {0, 1, 2}, places)},
            {of_node(0, "rotation"),
             keys<float>(linear, {0, 1, 2}, "VEC4", 4, {0, 0, 0, 1, 0, 0.6f, 0, 0.8f, 0.6f, 0, 0, 0.8f})},
            {of_node(0, "scale"), vectors(linear, {0, 2}, {1, 1, 1, 2, 3, 1})}},
           linear, 1e-9);
  EXPECT_THAT(remarks_, Not(Contains(HasSubstr("approximate"))));
  GltfFile spline = triangle();
  std::vector<float> numbers;
  for (std::size_t key = 0; key < 3; ++key)
    for (const float part : {3.0f, 1.0f, -2.0f})
      for (std::size_t c = 0; c < 3; ++c) numbers.push_back(part * places[3 * key + c]);
  vertices({{of_node(0, "translation"), vectors(spline, {0, 1, 2}, numbers, "CUBICSPLINE")}}, spline, 1e-3);
  EXPECT_THAT(remarks_, Contains(HasSubstr("is approximate")));
  GltfFile vanishing = triangle();
  SceneDescription gone = good_gltf(
      vanishing.text(moving({{of_node(0, "scale"), vectors(vanishing, {0, 1}, {1, 1, 1, 0, 0, 0})}})));
  show(gone, 0.5);
  SceneDescription written = again(gone);
  GltfMotion::expect_near(vertex(written, 9, 1), {0.5, 0, 0});
  EXPECT_THAT(remarks_, Contains(HasSubstr("as at 0.5 s, because keys of matrices cannot have its motion")));
}

}  // namespace
}  // namespace penumbra
