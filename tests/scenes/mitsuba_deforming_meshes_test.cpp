// Meshes of several files over time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/mesh_writer.h"
#include "scenes/motion/motion_facts.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/transform.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/scenes/serialized_writer.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

using ::testing::Contains;
using ::testing::Not;

class MitsubaDeformingMeshes : public SceneText {
 protected:
  /// Some roundings of doubles below 10.
  static constexpr double kRounding = 1e-14;

  /// Two triangles that share an edge, each bent by `height`, and moved.
  static Mesh bent(double height, const glm::dvec3& moved = glm::dvec3(0.0)) {
    Mesh mesh;
    mesh.positions = {{0, 0, height}, {1, 0, 0}, {1, 1, height}, {0, 1, 0}};
    for (glm::dvec3& p : mesh.positions) p += moved;
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  }
  static std::string obj_of(const Mesh& mesh) {
    std::string text;
    for (const glm::dvec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const glm::uvec3& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
    return text;
  }
  static std::string files(std::initializer_list<std::pair<double, const char*>> keys) {
    std::string text = "<animation name='filename'>";
    for (const auto& [time, name] : keys) text += fmt::format("<string time='{}' value='{}'/>", time, name);
    return text + "</animation>";
  }
  static std::string open(double from, double to) {
    return fmt::format(
        "<sensor type='perspective'><float name='shutter_open' value='{}'/><float name='shutter_close' "
        "value='{}'/></sensor>",
        from, to);
  }
  static std::string faceted() { return "<boolean name='face_normals' value='true'/>"; }
  static Mesh mesh_at(const SceneDescription& scene, double time, std::size_t shape = 0) {
    SceneDescription moved = scene;
    const auto done = set_time(moved, time);
    EXPECT_TRUE(done) << done.error().message;
    return std::get<Mesh>(moved.shapes.at(shape).geometry);
  }
  static void expect_mesh(const Mesh& made, const Mesh& wanted, double tolerance = kRounding) {
    ASSERT_EQ(made.positions.size(), wanted.positions.size());
    for (std::size_t i = 0; i < wanted.positions.size(); ++i)
      EXPECT_LE(glm::distance(made.positions[i], wanted.positions[i]), tolerance) << i;
    EXPECT_EQ(made.triangles, wanted.triangles);
    ASSERT_EQ(made.normals.size(), wanted.normals.size());
    for (std::size_t i = 0; i < wanted.normals.size(); ++i)  // which are in single precision
      EXPECT_LE(glm::distance(made.normals[i], wanted.normals[i]), std::max(1e-6f, float(tolerance))) << i;
  }
  static DeviceScene built(const SceneDescription& scene) {
    auto made = build_device_scene(scene, {.feature_layers = false});
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : DeviceScene();
  }
  SceneDescription again(const SceneDescription& scene) {
    remarks_.clear();
    const auto written = mitsuba::scene_files(scene, folder_ / "written.xml", &remarks_);
    EXPECT_TRUE(written) << written.error().message;
    if (written)
      for (const mitsuba::SceneFile& file : *written) write_text(file.path, file.contents);
    return good_of(read_scene(folder_ / "written.xml", {}));
  }

  std::vector<std::string> remarks_;
};

TEST_F(MitsubaDeformingMeshes, VerticesMoveEvenlyFromFileToFile) {
  const Mesh first = bent(0.5), second = bent(1.5, {2, 0, 0}), third = bent(0.25, {2, 4, 0});
  write("a.ply", ply_of(first));
  write("b.ply", ply_of(second));
  write("c.ply", ply_of(third));
  const SceneDescription s =
      good(open(0, 0) + in("shape", "ply", faceted() + files({{0, "a.ply"}, {0.5, "b.ply"}, {2, "c.ply"}})));
  expect_mesh(mesh_at(s, -1), first);
  expect_mesh(mesh_at(s, 0), first);
  expect_mesh(mesh_at(s, 0.125), bent(0.75, {0.5, 0, 0}));
  expect_mesh(mesh_at(s, 0.5), second);
  expect_mesh(mesh_at(s, 1.7), bent(0.5, {2, 3.2, 0}));
  expect_mesh(mesh_at(s, 9), third);
  const auto facts = motion_facts(s);
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->meshes_that_deform, 1u);
  EXPECT_EQ(facts->times, std::pair(0.0, 2.0));
}

/// As those of a still of that time.
TEST_F(MitsubaDeformingMeshes, NormalsAreComputedAtEachTime) {
  write("a.obj", obj_of(bent(0.5)));
  write("b.obj", obj_of(bent(1.5)));
  write("half.obj", obj_of(bent(1.0)));
  const SceneDescription s = good(in("shape", "obj", files({{0, "a.obj"}, {1, "b.obj"}}))),
                         still = good(in("shape", "obj", "<string name='filename' value='half.obj'/>"));
  ASSERT_EQ(mesh_at(s, 0.5).normals.size(), 4u);
  expect_mesh(mesh_at(s, 0.5), std::get<Mesh>(still.shapes.at(0).geometry));
}

TEST_F(MitsubaDeformingMeshes, NormalsOfFilesAreInterpolated) {
  Mesh a = bent(0.5), b = bent(0.5);
  a.normals.assign(4, {0, 0, 1});
  b.normals.assign(4, glm::normalize(glm::vec3(1, 0, 1)));
  write("a.ply", ply_of(a));
  write("b.ply", ply_of(b));
  const SceneDescription s = good(in("shape", "ply", files({{0, "a.ply"}, {1, "b.ply"}})));
  const glm::vec3 half = glm::normalize(a.normals[0] + b.normals[0]);
  for (const glm::vec3& n : mesh_at(s, 0.5).normals) EXPECT_LE(glm::distance(n, half), 1e-6f);
}

TEST_F(MitsubaDeformingMeshes, AreInPlacesThatMoveToo) {
  write("a.ply", ply_of(bent(0.5)));
  write("b.ply", ply_of(bent(1.5)));
  const std::string deforms = faceted() + files({{0, "a.ply"}, {1, "b.ply"}}),
                    moves =
                        "<animation name='to_world'><transform time='0'><scale value='2'/></transform>"
                        "<transform time='2'><scale value='2'/><translate x='4'/></transform></animation>";
  const auto placed = [](const Mesh& mesh, const glm::dmat4& matrix) {
    Mesh made = mesh;
    for (glm::dvec3& p : made.positions) p = transform_point(matrix, p);
    return made;
  };
  const SceneDescription s = good(in("shape", "ply", deforms + to_world("<translate y='3'/>")) +
                                  in("shape", "ply", deforms + moves));
  expect_mesh(mesh_at(s, 0.5, 0), placed(bent(1.0), translation({0, 3, 0})));
  expect_mesh(mesh_at(s, 0.5, 1), placed(bent(1.0), translation({1, 0, 0}) * scaling(glm::dvec3(2.0))));
  // In a group, in its own space.
  SceneDescription group =
      good("<shape type='shapegroup' id='g'>" + in("shape", "ply", deforms) + "</shape>" +
           in("shape", "instance", "<ref id='g'/>" + to_world("<translate z='1'/>")));
  EXPECT_EQ(moving_instances(group), std::vector<bool>{true});
  ASSERT_TRUE(set_time(group, 0.5));
  expect_mesh(std::get<Mesh>(group.groups.at(0).shapes.at(0).geometry), bent(1.0));
}

TEST_F(MitsubaDeformingMeshes, OfAllFormats) {
  SerializedWriter a(4), b(4);
  for (const double offset : {0.0, 1.0}) {
    a.add(bent(0.5 + offset), {.doubles = true});
    b.add(bent(1.5 + offset), {.doubles = true});
  }
  write("a.serialized", a.file());
  write("b.serialized", b.file());
  const SceneDescription s = good(in("shape", "serialized",
                                     faceted() + "<integer name='shape_index' value='1'/>" +
                                         files({{0, "a.serialized"}, {1, "b.serialized"}})));
  expect_mesh(mesh_at(s, 0.5), bent(2.0));
  // Each material of a file is a shape.
  const auto two = [&](double height) {
    std::string text = obj_of(bent(height));
    text.insert(text.find("f 1 2 3"), "usemtl left\n");
    text.insert(text.find("f 1 3 4"), "usemtl right\n");
    return text;
  };
  write("a.obj", two(0.5));
  write("b.obj", two(1.5));
  const std::string materials = "<bsdf type='diffuse' name='left'/><bsdf type='conductor' name='right'/>";
  const SceneDescription parts =
      good(in("shape", "obj", materials + faceted() + files({{0, "a.obj"}, {1, "b.obj"}})));
  ASSERT_EQ(parts.shapes.size(), 2u);
  Mesh left = bent(1.0), right = bent(1.0);
  left.positions = {left.positions[0], left.positions[1], left.positions[2]};
  right.positions = {right.positions[0], right.positions[2], right.positions[3]};
  left.triangles = right.triangles = {{0, 1, 2}};
  expect_mesh(mesh_at(parts, 0.5, 0), left);
  expect_mesh(mesh_at(parts, 0.5, 1), right);
}

/// A triangle that its transform stretches is one whose vertices move: the kernels get the same scene.
TEST_F(MitsubaDeformingMeshes, AStretchIsAMotionOfVertices) {
  Mesh triangle;
  triangle.positions = {{-1, -0.5, 4}, {0.5, -1, 5}, {0, 1, 4.5}};
  triangle.triangles = {{0, 1, 2}};
  Mesh stretched = triangle;
  for (glm::dvec3& p : stretched.positions) p = transform_point(scaling({2, 0.5, 1}), p);
  write("a.ply", ply_of(triangle));
  write("b.ply", ply_of(stretched));
  // A light, because other shapes that move rigidly are placed by a matrix.
  const std::string light = faceted() + in("emitter", "area");
  const auto device = [&](const std::string& inside) {
    return built(good(open(0, 1) + in("integrator", "path") + in("shape", "cube") +
                      in("shape", "ply", light + inside)));
  };
  const DeviceScene vertices = device(files({{0, "a.ply"}, {1, "b.ply"}})),
                    transform = device(
                        "<string name='filename' value='a.ply'/><animation name='to_world'><transform "
                        "time='0'/><transform time='1'><scale x='2' y='0.5' z='1'/></transform></animation>");
  ASSERT_GT(vertices.header.tables.triangle_motions.count, 0);
  EXPECT_EQ(vertices.words, transform.words);
}

TEST_F(MitsubaDeformingMeshes, WhatDoesNotChangeDoesNotMove) {
  write("a.ply", ply_of(bent(0.5)));
  for (const std::string& same : {files({{0, "a.ply"}, {1, "a.ply"}}), files({{3, "a.ply"}})}) {
    const SceneDescription s = good(in("shape", "ply", faceted() + same));
    EXPECT_EQ(s.motion, nullptr);
    expect_mesh(std::get<Mesh>(s.shapes.at(0).geometry), bent(0.5));
  }
}

/// Flat at its first key, and not afterwards.
TEST_F(MitsubaDeformingMeshes, MayBeFlatAtATime) {
  Mesh flat = bent(0);
  for (glm::dvec3& p : flat.positions) p.y = 0;
  write("a.ply", ply_of(flat));
  write("b.ply", ply_of(bent(0.5)));
  const SceneDescription s = good(in("shape", "ply", faceted() + files({{0, "a.ply"}, {1, "b.ply"}})));
  EXPECT_TRUE(mesh_at(s, 0).triangles.empty());
  expect_mesh(mesh_at(s, 1), bent(0.5));
}

TEST_F(MitsubaDeformingMeshes, WhatIsWrongIsSaid) {
  write("a.ply", ply_of(bent(0.5)));
  Mesh other = bent(0.5);
  other.positions.emplace_back(5, 5, 5);
  write("five.ply", ply_of(other));
  other = bent(0.5);
  other.triangles.pop_back();
  write("one.ply", ply_of(other));
  other = bent(0.5);
  other.normals.assign(4, {0, 0, 1});
  write("normals.ply", ply_of(other));
  const auto wrong = [&](const std::string& inside, const char* type = "ply") {
    return error(scene(in("shape", type, inside)));
  };
  const auto against = [&](const char* name) { return wrong(files({{0.5, "a.ply"}, {1, name}})); };
  EXPECT_THAT(against("five.ply"),
              AllOf(HasSubstr("scene.xml:2:"),
                    HasSubstr("'five.ply' has 5 vertices, 2 triangles, no normals; 'a.ply' at 0.5 s has 4 "
                              "vertices, 2 triangles, no normals. The files of a mesh over time differ in")));
  EXPECT_THAT(against("one.ply"), HasSubstr("'one.ply' has 4 vertices, 1 triangles"));
  EXPECT_THAT(against("normals.ply"), HasSubstr("'normals.ply' has 4 vertices, 2 triangles, normals;"));
  EXPECT_THAT(against("none.ply"), AllOf(HasSubstr("scene.xml:2:"), HasSubstr("none.ply")));
  EXPECT_THAT(wrong(files({{1, "a.ply"}, {1, "a.ply"}})), HasSubstr("must ascend; 1 follows 1"));
  EXPECT_THAT(wrong(files({})), HasSubstr("holds at least one <transform time"));
  EXPECT_THAT(wrong("<animation name='filename'><string value='a.ply'/></animation>"), HasSubstr("time"));
  EXPECT_THAT(wrong("<animation name='filename'><string time='0'/></animation>"), HasSubstr("value"));
  EXPECT_THAT(wrong("<animation name='filename'><string time='inf' value='a.ply'/></animation>"),
              HasSubstr("inf"));
  EXPECT_THAT(wrong("<animation name='filename'><string time='0' value='a.ply'/><transform "
                    "time='1'/></animation>"),
              HasSubstr("holds either <transform"));
  write("bent.obj", obj_of(bent(0.5)));
  EXPECT_THAT(
      wrong("<float name='max_smooth_angle' value='30'/>" + files({{0, "bent.obj"}, {1, "bent.obj"}}), "obj"),
      HasSubstr("max_smooth_angle"));
  write("left.obj", "usemtl left\n" + obj_of(bent(0.5)));
  write("right.obj", "usemtl right\n" + obj_of(bent(0.5)));
  EXPECT_THAT(wrong("<bsdf type='diffuse' name='left'/><bsdf type='diffuse' name='right'/>" +
                        files({{0, "left.obj"}, {1, "right.obj"}}),
                    "obj"),
              HasSubstr("'right.obj' has other objects or materials than 'left.obj' at 0 s"));
  // Other files than those of meshes stay.
  EXPECT_THAT(warnings(good(in("shape", "sphere") +
                                in("emitter", "point",
                                   "<animation name='id'><string time='0' value='a'/><string time='1' "
                                   "value='b'/></animation>"),
                            {.lenient = true})),
              HasSubstr("the id of emitter 'point' stays 'a'"));
}

/// Written and read again, meshes are where they were while the shutter is open.
TEST_F(MitsubaDeformingMeshes, AreWrittenAndReadAgain) {
  write("a.ply", ply_of(bent(0.5)));
  write("b.ply", ply_of(bent(1.5, {0, 1, 0})));
  write("c.ply", ply_of(bent(0.25)));
  const std::string deforms = files({{0, "a.ply"}, {0.5, "b.ply"}, {2, "c.ply"}}),
                    moves =
                        "<animation name='to_world'><transform time='0'><scale value='-2'/></transform>"
                        "<transform time='1'><scale value='-2'/><translate x='4'/></transform></animation>";
  const SceneDescription scene = good(open(0.25, 1) + in("shape", "ply", deforms + moves) +
                                      in("shape", "ply", faceted() + deforms + to_world("<scale x='-1'/>")) +
                                      "<shape type='shapegroup' id='g'>" + in("shape", "ply", deforms) +
                                      "</shape>" + in("shape", "instance", "<ref id='g'/>"));
  const SceneDescription written = again(scene);
  for (const double time : {0.25, 0.3, 0.5, 0.8, 1.0}) {
    SCOPED_TRACE(time);
    for (const std::size_t shape : {0u, 1u})
      expect_mesh(mesh_at(written, time, shape), mesh_at(scene, time, shape));
    SceneDescription before = scene, after = written;
    ASSERT_TRUE(set_time(before, time));
    ASSERT_TRUE(set_time(after, time));
    expect_mesh(std::get<Mesh>(after.groups.at(0).shapes.at(0).geometry),
                std::get<Mesh>(before.groups.at(0).shapes.at(0).geometry));
  }
  EXPECT_THAT(remarks_, Contains(HasSubstr("meshes deform only from 0.25 to 1 s")));
  EXPECT_THAT(remarks_, Not(Contains(HasSubstr("approximate"))));
}

/// Morph targets, and a skin, whose joints turn.
TEST_F(MitsubaDeformingMeshes, OfGltfAreWritten) {
  const auto file = std::filesystem::path(PENUMBRA_SOURCE_DIR) / "tests/scenes/animated.glb";
  auto scene = read_scene(file, {.settings = {{"camera.shutter", "6"}}, .time = 0.25, .fps = 24.0});
  ASSERT_TRUE(scene) << scene.error().message;
  const SceneDescription written = again(*scene);
  ASSERT_EQ(written.shapes.size(), scene->shapes.size());
  EXPECT_EQ(motion_facts(written)->meshes_that_deform, motion_facts(*scene)->meshes_that_deform);
  EXPECT_GT(motion_facts(written)->meshes_that_deform, 0u);
  for (const double time : {0.25, 0.26, 0.31, 0.4, 0.49})
    for (const MovingShape& moving : scene->motion->shapes) {
      if (moving.deformation == nullptr) continue;
      const std::size_t i = moving.shape;
      SCOPED_TRACE(fmt::format("{} at {} s", scene->shapes[i].name, time));
      const Mesh made = mesh_at(written, time, i), wanted = mesh_at(*scene, time, i);
      ASSERT_EQ(made.positions.size(), wanted.positions.size());
      for (std::size_t v = 0; v < wanted.positions.size(); ++v)  // of an extent of some units
        EXPECT_LE(glm::distance(made.positions[v], wanted.positions[v]), 1e-3);
    }
}

}  // namespace
}  // namespace penumbra
