// Groups of shapes and their instances, and merged shapes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/instances.h"
#include "scenes/transform.h"
#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class MitsubaInstances : public SceneText {
 protected:
  static std::string instance(const std::string& id, const std::string& transform = "") {
    return "<shape type='instance'><ref id='" + id + "'/>" +
           (transform.empty() ? "" : "<transform name='toWorld'>" + transform + "</transform>") + "</shape>";
  }
};

const std::string kGroup =
    "<shape type='shapegroup' id='g'><shape type='sphere' id='ball'/><shape type='cube'>"
    "<transform name='to_world'><translate x='3'/></transform></shape></shape>";

TEST_F(MitsubaInstances, PlaceGroups) {
  const SceneDescription s =
      good(kGroup + instance("g") + instance("g", "<scale value='2'/><translate y='5'/>"));
  EXPECT_THAT(s.shapes, IsEmpty());
  ASSERT_THAT(s.groups, SizeIs(1));
  EXPECT_EQ(s.groups[0].name, "g");
  EXPECT_THAT(s.groups[0].shapes, SizeIs(2));
  ASSERT_THAT(s.instances, SizeIs(2));
  EXPECT_EQ(s.instances[0].to_world, glm::dmat4(1.0));
  EXPECT_EQ(transform_point(s.instances[1].to_world, {1, 1, 0}), glm::dvec3(2, 7, 0));
  EXPECT_THAT(s.warnings, IsEmpty());
}

TEST_F(MitsubaInstances, AGroupMayComeAfterItsInstancesOrWithinOne) {
  EXPECT_THAT(good(instance("g") + kGroup).instances, SizeIs(1));
  EXPECT_THAT(good("<shape type='instance'>" + kGroup + "</shape>").groups, SizeIs(1));
  const SceneDescription unused = good(kGroup + "<shape type='disk'/>");
  EXPECT_THAT(unused.instances, IsEmpty());
  EXPECT_THAT(unused.shapes, SizeIs(1));
}

TEST_F(MitsubaInstances, OfInstances) {
  const SceneDescription s =
      good("<shape type='shapegroup' id='outer'><shape type='disk'/>" + instance("g", "<translate x='1'/>") +
           instance("g", "<translate x='2'/>") + "</shape>" + kGroup +
           instance("outer", "<scale value='10'/>") + instance("g"));
  const auto placed = place_groups(s);
  ASSERT_TRUE(placed) << placed.error().message;
  ASSERT_THAT(*placed, SizeIs(4));
  std::vector<double> places;
  for (const PlacedGroup& place : *placed) places.push_back(transform_point(place.to_world, {0, 0, 0}).x);
  EXPECT_THAT(places, ElementsAre(0, 10, 20, 0)) << "the group's own disk, its two instances, the scene's";
  const auto flat = without_instances(s);
  ASSERT_TRUE(flat) << flat.error().message;
  EXPECT_THAT(flat->shapes, SizeIs(1 + 3 * 2));
  EXPECT_THAT(flat->groups, IsEmpty());
}

TEST_F(MitsubaInstances, Errors) {
  EXPECT_THAT(error(scene("<shape type='instance'/>")),
              HasSubstr("an instance needs a <shape type=\"shapegroup\">"));
  EXPECT_THAT(error(scene("<shape type='sphere' id='s'/>" + instance("s"))),
              HasSubstr("an instance needs a <shape type=\"shapegroup\">"));
  EXPECT_THAT(error(scene("<shape type='shapegroup' id='g'>" + instance("g") + "</shape>" + instance("g"))),
              HasSubstr("the group holds an instance of itself"));
  EXPECT_THAT(error(scene("<shape type='shapegroup' id='a'>" + instance("b") + "</shape>" +
                          "<shape type='shapegroup' id='b'>" + instance("a") + "</shape>" + instance("a"))),
              HasSubstr("the group holds an instance of itself"));
  EXPECT_THAT(error(scene("<shape type='shapegroup' id='a'>" + kGroup + "</shape>")),
              HasSubstr("a group holds no groups"));
  EXPECT_THAT(error(scene(kGroup + instance("g", "<scale x='0' y='1' z='1'/>"))), HasSubstr("singular"));
  EXPECT_THAT(error(scene(kGroup + "<shape type='instance'><ref id='g'/><bsdf type='diffuse'/></shape>")),
              HasSubstr("bsdf"));
}

TEST_F(MitsubaInstances, NotTooDeep) {
  std::string text = "<shape type='shapegroup' id='g0'><shape type='disk'/></shape>";
  for (int i = 1; i < 5000; ++i)
    text += "<shape type='shapegroup' id='g" + std::to_string(i) + "'>" +
            instance("g" + std::to_string(i - 1)) + "</shape>";
  EXPECT_THAT(error(scene(instance("g4999") + text)),
              HasSubstr("shapes within shapes of more than 64 levels"));
  EXPECT_THAT(place_groups(good(text + instance("g63"))).value(), SizeIs(1));
  // Read from the innermost on, what is inside is known already.
  const auto placed = place_groups(good(text + instance("g64")));
  ASSERT_FALSE(placed);
  EXPECT_THAT(placed.error().message, HasSubstr("more than 64 levels"));
}

TEST_F(MitsubaInstances, MergedShapesKeepTheirMaterials) {
  const SceneDescription s = good(
      "<shape type='merge'><shape type='sphere'><bsdf type='conductor'/></shape><shape type='merge'>"
      "<shape type='cube'/></shape></shape>");
  ASSERT_THAT(s.shapes, SizeIs(2));
  EXPECT_NE(s.shapes[0].front_bsdf, s.shapes[1].front_bsdf);
}

// --- what readers cannot know

SceneDescription two_groups(const glm::dmat4& to_world) {
  SceneDescription s;
  Shape ball;
  ball.geometry = Sphere{};
  s.groups = {{"inner", {ball}, {}}, {"outer", {}, {{"half", 0, scaling(glm::dvec3(0.5))}}}};
  s.instances = {{"whole", 1, to_world}};
  return s;
}

TEST(PlacedGroups, DegenerateTransformsAreRefusedWithTheReason) {
  const auto reason = [](const glm::dmat4& m) {
    const auto placed = place_groups(two_groups(m));
    return placed ? std::string() : placed.error().message;
  };
  EXPECT_EQ(reason(glm::dmat4(1.0)), "");
  EXPECT_EQ(reason(scaling({1e-9, -1e9, 1})), "");
  EXPECT_THAT(reason(scaling({1, 0, 1})), HasSubstr("instance 'whole': its transform flattens space"));
  EXPECT_THAT(reason(scaling({1e-13, 1, 1})), HasSubstr("makes lengths too large or too small"));
  EXPECT_THAT(reason(scaling({1, 1e13, 1})), HasSubstr("makes lengths too large or too small"));
  glm::dmat4 far(1.0);
  far[3].x = std::numeric_limits<double>::infinity();
  EXPECT_THAT(reason(far), HasSubstr("numbers that are not finite"));
}

TEST(PlacedGroups, TooManyAreRefusedBeforeTheyAreMade) {
  SceneDescription s = two_groups(glm::dmat4(1.0));
  for (int level = 2; level < 40; ++level)  // each holds the one before it a hundred times
    s.groups.push_back({"level", {}, std::vector<ShapeInstance>(100, {"", level - 1, glm::dmat4(1.0)})});
  s.instances[0].group = 39;
  const auto placed = place_groups(s);
  ASSERT_FALSE(placed);
  EXPECT_THAT(placed.error().message, HasSubstr("more than 16777216 instances"));
  s.instances[0].group = 4;
  EXPECT_THAT(*place_groups(s), SizeIs(1'000'000));
}

TEST(PlacedShapes, FollowTheirNormalsAndAreRefusedAsOtherShapes) {
  const glm::dmat4 mirror = translation({1, 2, 3}) * scaling({-2, 2, 2});
  Shape mesh;
  mesh.geometry =
      Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {}, {}, {{0, 1, 2}}, {}};
  const auto placed = placed_shape(mesh, mirror);
  ASSERT_TRUE(placed);
  const Mesh& there = std::get<Mesh>(placed->geometry);
  const auto& p = there.positions;
  const auto t = there.triangles[0];
  EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0);
  EXPECT_EQ(there.normals[0], glm::vec3(0, 0, 1));
  Shape ball;
  ball.geometry = Sphere{{1, 0, 0}, 0.5};
  EXPECT_EQ(std::get<Sphere>(placed_shape(ball, mirror)->geometry).center, glm::dvec3(-1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(placed_shape(ball, mirror)->geometry).radius, 1.0);
  EXPECT_FALSE(placed_shape(ball, scaling({1, 2, 1})));
  Shape disk;
  disk.geometry = Disk{};
  EXPECT_EQ(std::get<Disk>(placed_shape(disk, scaling({3, 3, 1}))->geometry).radius, 3.0);
  EXPECT_FALSE(placed_shape(disk, scaling({3, 1, 1})));
}

}  // namespace
}  // namespace penumbra
