// What moves while the shutter is open: states against the scene at their times, and the hierarchy's boxes
// against states as kernels interpolate them.
#include "kernels/motion/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <random>
#include <string>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/transform.h"
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

std::string key(double time, std::string_view steps) {
  return "<transform time='" + std::to_string(time) + "'>" + std::string(steps) + "</transform>";
}
std::string moving(std::string_view first, std::string_view last) {
  return "<animation name='to_world'>" + key(0, first) + key(1, last) + "</animation>";
}
std::string integrator() { return in("integrator", "path"); }

/// A scene whose shutter is open from time 0 to 1.
class MotionTablesTest : public SceneText {
 protected:
  SceneDescription open(const std::string& inside, std::string_view of_sensor = "") {
    SceneDescription scene =
        good(integrator() +
             "<sensor type='perspective'><float name='shutter_open' value='0'/><film type='hdrfilm'><integer "
             "name='width' value='100'/><integer name='height' value='80'/></film>" +
             std::string(of_sensor) + "</sensor>" + inside);
    scene.time = 0.0;
    scene.frame_duration = 1.0;
    scene.camera.shutter = 1.0f;
    EXPECT_DOUBLE_EQ(exposure_of(scene).close - exposure_of(scene).open, 1.0);
    return scene;
  }
  static DeviceScene built(const SceneDescription& scene) {
    auto made = build_device_scene(scene, {.feature_layers = false});
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : DeviceScene();
  }
};

const char* const kStill =
    "<shape type='rectangle'/><shape type='rectangle'><emitter type='area'><rgb name='radiance' "
    "value='1'/></emitter></shape>";

/// Calls with(scene) with the scene as kernels see it.
Scene kernel_scene(const DeviceScene& scene) { return make_scene(scene.header, scene.words.data()); }

double far(const vec3& a, const glm::dvec3& b) { return glm::length(glm::dvec3(a.x, a.y, a.z) - b); }

TEST_F(MotionTablesTest, StillScenesHaveNoTables) {
  const DeviceScene scene = built(open(kStill));
  EXPECT_EQ(scene.header.features & (FEATURE_MOTION | FEATURE_MOTION_LAYER), 0u);
  EXPECT_EQ(scene.header.tables.shutter.count, 0);
}

TEST_F(MotionTablesTest, ARigidMeshIsAnInstance) {
  const SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube'>" +
           moving("<translate x='5'/>", "<rotate z='1' angle='90'/><translate x='9' y='1'/>") + "</shape>");
  const DeviceScene device = built(scene);
  const TableSpans& t = device.header.tables;
  ASSERT_NE(device.header.features & FEATURE_MOTION, 0u);
  ASSERT_EQ(t.instance_motions.count, 1);
  EXPECT_EQ(t.triangle_motions.count, 0);
  EXPECT_EQ(t.camera_states.count, 0);
  const Scene s = kernel_scene(device);
  const Motion m = s.instance_motions[0];
  SceneDescription at = scene;
  for (int k = 0; k <= m.steps; ++k) {
    const double time = double(k) / m.steps;
    ASSERT_TRUE(set_time(at, time));
    const Instance i = instance_at(&s, 0, float(time));
    const auto& mesh = std::get<Mesh>(at.shapes[2].geometry);
    const PrimitiveGroup group = s.groups[i.group];
    ASSERT_EQ(group.triangle_count, int(mesh.triangles.size()));
    for (int f = 0; f < group.triangle_count; ++f)
      EXPECT_LT(far(from_group_point(i, s.triangles[group.first_triangle + f].p1),
                    mesh.positions[mesh.triangles[std::size_t(f)].y] - scene_center(at)),
                1e-5);
  }
}

TEST_F(MotionTablesTest, MovingEmittersHaveStates) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  const SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube'>" + light +
               moving("<translate x='5'/>", "<scale value='2'/><translate x='9' y='1'/>") +
               "</shape><shape "
               "type='sphere'>" +
               light + moving("", "<scale value='3'/><translate z='4'/>") + "</shape>",
           moving("<lookat origin='0,0,-9' target='0,0,0' up='0,1,0'/>",
                  "<lookat origin='0,4,-9' target='0,0,0' up='0,1,0'/>"));
  const DeviceScene device = built(scene);
  const TableSpans& t = device.header.tables;
  ASSERT_EQ(t.triangle_motions.count, 12);
  ASSERT_EQ(t.quadric_motions.count, 1);
  ASSERT_EQ(t.light_motions.count, t.lights.count);
  const Scene s = kernel_scene(device);
  EXPECT_GT(s.shutter->camera_steps, 0);
  for (int i = 0; i < t.triangles.count; ++i) {
    const Triangle& triangle = s.triangles[i];
    if (!triangle_moves(&s, i)) continue;
    ASSERT_GE(triangle.light, 0);
    EXPECT_EQ(s.lights[triangle.light].kind, LIGHT_TRIANGLE);
    const Motion m = s.light_motions[triangle.light];
    for (const float time : {0.0f, 0.3f, 1.0f}) {
      const TriangleState state = triangle_at(&s, i, time);
      const Between b = between_states(m, time);
      const vec3 p2 = STATE_BETWEEN(s.light_states, p2);
      EXPECT_EQ(state.p2.x, p2.x);
      EXPECT_EQ(state.p2.y, p2.y);
      EXPECT_EQ(state.p2.z, p2.z);
    }
  }
  // At its states the mesh is where the scene has it.
  const Motion of_cube = s.triangle_motions[0];
  SceneDescription posed = scene;
  for (int k = 0; k <= of_cube.steps; ++k) {
    const double time = double(k) / of_cube.steps;
    ASSERT_TRUE(set_time(posed, time));
    const auto& mesh = std::get<Mesh>(posed.shapes[2].geometry);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
      const TriangleState state = triangle_at(&s, s.shutter->still_triangles + int(f), float(time));
      EXPECT_LT(far(state.p0, mesh.positions[mesh.triangles[f].x] - scene_center(posed)), 1e-5);
      EXPECT_LT(far(state.p2, mesh.positions[mesh.triangles[f].z] - scene_center(posed)), 1e-5);
    }
  }
  const Quadric end = quadric_at(&s, s.shutter->still_quadrics, 1.0f);
  EXPECT_NEAR(end.radius, 3, 1e-6);
  SceneDescription at = scene;
  ASSERT_TRUE(set_time(at, 0.5));
  EXPECT_LT(far(end.center, glm::dvec3(0, 0, 4) - scene_center(at)), 1e-5);
}

/// The number of steps of the only instance that moves.
int steps_of(const DeviceScene& device) {
  EXPECT_EQ(device.header.tables.instance_motions.count, 1);
  return device.header.tables.instance_motions.count == 1 ? kernel_scene(device).instance_motions[0].steps
                                                          : 0;
}

TEST_F(MotionTablesTest, StepsFollowThePathWithinATenthOfAPixel) {
  const auto shape = [&](const std::string& animation) {
    return built(open(std::string(kStill) + "<shape type='cube'>" + animation + "</shape>",
                      to_world("<lookat origin='0,0,-20' target='0,0,0' up='0,1,0'/>")));
  };
  EXPECT_EQ(steps_of(shape(moving("", "<translate x='5' z='1'/>"))), 1);
  // A linear path with a corner at 1/4.
  EXPECT_EQ(steps_of(shape("<animation name='to_world'>" + key(0, "") + key(0.25, "<translate x='1'/>") +
                           key(1, "<translate y='2'/>") + "</animation>")),
            4);
  // A turn about the axis of a cube: the sagitta of the chord of a step, at the corners of the front, in
  // pixels of the film's corner.
  const SceneDescription view = open("");
  const HalfFilm half = half_film(view.camera, view.film);
  const double distance = std::sqrt(19.0 * 19.0 + 2.0);
  const double radius_in_pixels =
      std::sqrt(2.0) / distance * 50 / half.x * (1 + half.x * half.x + half.y * half.y);
  for (const double degrees : {20.0, 60.0, 90.0, 170.0}) {
    int wanted = 1;
    while (radius_in_pixels * (1 - std::cos(degrees * 3.14159265358979 / 360 / wanted)) > 0.1) wanted *= 2;
    EXPECT_EQ(steps_of(shape(moving("", "<rotate z='1' angle='" + std::to_string(degrees) + "'/>"))), wanted)
        << degrees;
  }
}

TEST_F(MotionTablesTest, FastTurnsAreNotTakenForStillnessAndAWarningNamesThem) {
  std::string keys;
  constexpr int kTurns = 64;  // a state at each full turn
  for (int i = 0; i <= 3 * kTurns; ++i)
    keys += key(double(i) / (3 * kTurns), "<rotate z='1' angle='" + std::to_string(120 * i) + "'/>");
  const SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube' id='top'><animation name='to_world'>" + keys +
               "</animation></shape>",
           to_world("<lookat origin='0,0,-20' target='0,0,0' up='0,1,0'/>"));
  std::vector<std::string> warnings;
  const auto device = build_device_scene(scene, {.warnings = &warnings});
  ASSERT_TRUE(device) << device.error().message;
  EXPECT_EQ(steps_of(*device), 64);
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("'top' moves too fast"), HasSubstr("64 steps"))));
}

TEST_F(MotionTablesTest, WhatMovesAtOtherTimesIsStill) {
  const SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube'><animation name='to_world'>" + key(2, "") +
           key(3, "<translate x='5' z='1'/>") + "</animation></shape>");
  const DeviceScene blurred = built(scene);
  EXPECT_EQ(blurred.header.features & FEATURE_MOTION, 0u);
  SceneDescription instant = scene;
  instant.camera.shutter = 0.0f;
  EXPECT_EQ(blurred.serialize(), built(instant).serialize());
  SceneDescription layered = scene;
  layered.film.layers = {AskedLayer::kMotion};
  layered.time = 1.5;  // the next frame is during the motion
  const DeviceScene with_layer = built(layered);
  EXPECT_EQ(with_layer.header.tables.instance_motions.count, 1);
  layered.time = 0.0;
  const DeviceScene still_layer = built(layered);
  EXPECT_EQ(still_layer.header.tables.instance_motions.count, 0);
  EXPECT_EQ(still_layer.header.features & (FEATURE_MOTION | FEATURE_MOTION_LAYER),
            FEATURE_MOTION | FEATURE_MOTION_LAYER);
}

TEST_F(MotionTablesTest, ACameraThatSettingsPlaceStaysThere) {
  SceneDescription scene = open(kStill, moving("<lookat origin='0,0,-20' target='0,0,0' up='0,1,0'/>",
                                               "<lookat origin='5,0,-20' target='0,0,0' up='0,1,0'/>"));
  ASSERT_GT(built(scene).header.tables.camera_states.count, 0);
  scene.camera.to_world[3].y += 1;
  const DeviceScene placed = built(scene);
  EXPECT_EQ(placed.header.tables.camera_states.count, 0);
  EXPECT_EQ(placed.header.camera.origin.y, float(1 - scene_center(scene).y));
}

TEST_F(MotionTablesTest, AStillSceneMayHaveALayerOfMotion) {
  SceneDescription scene = open(kStill);
  scene.film.layers = {AskedLayer::kMotion};
  EXPECT_EQ(built(scene).header.features & (FEATURE_MOTION | FEATURE_MOTION_LAYER), FEATURE_MOTION_LAYER);
}

TEST_F(MotionTablesTest, AnEarlierFrameGivesTheSameBytes) {
  SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube'>" +
           moving("", "<rotate z='1' angle='90'/><translate x='9' y='1'/>") + "</shape>");
  scene.camera.shutter = 0.25f;
  const DeviceScene first = built(scene);
  ASSERT_TRUE(set_time(scene, 0.5));
  const auto with = build_device_scene(scene, {.feature_layers = false, .earlier = &first});
  ASSERT_TRUE(with) << with.error().message;
  EXPECT_EQ(with->serialize(), built(scene).serialize());
}

TEST_F(MotionTablesTest, EverythingMayMove) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  const std::string lamp = "<shape type='sphere'>" + light + moving("", "<translate x='1'/>") + "</shape>";
  const DeviceScene primitive = built(open(lamp));
  EXPECT_EQ(primitive.header.tables.quadric_motions.count, 1);
  EXPECT_TRUE(DeviceScene::deserialize(primitive.serialize()));
  const DeviceScene instance =
      built(open(lamp + "<shape type='cube'>" + moving("", "<translate x='1'/>") + "</shape>"));
  EXPECT_TRUE(DeviceScene::deserialize(instance.serialize()));
  EXPECT_EQ(instance.header.tables.instance_motions.count, 1);
  ASSERT_GE(instance.header.tables.nodes.count, 2);
  const BvhNode root = kernel_scene(instance).nodes[0];
  for (int k = 0; k < BVH_WIDTH; ++k) EXPECT_GT(root.bounds[0][k], root.bounds[3][k]);
}

TEST_F(MotionTablesTest, SmallScenesTestWhatIsStill) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  const DeviceScene device = built(open(std::string(kStill) + "<shape type='cube'>" + light +
                                        moving("", "<translate x='1'/>") + "</shape>"));
  EXPECT_EQ(device.header.features & FEATURE_BVH, 0u);
  EXPECT_EQ(device.header.tables.triangle_motions.count, 12);
  EXPECT_EQ(device.header.tables.corners.count, 4);
}

TEST_F(MotionTablesTest, WhatHasNoSizeAtATimeKeepsItsRecords) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  SceneDescription scene =
      open(std::string(kStill) + "<shape type='cube'/><shape type='cube'>" + light +
           "</shape><shape type='sphere'>" + light +
           "</shape><shape type='shapegroup' id='g'><shape type='cube'/></shape><shape type='instance'><ref "
           "id='g'/></shape>");
  ASSERT_EQ(scene.shapes.size(), 5u);
  ASSERT_EQ(scene.instances.size(), 1u);
  // Everything shrinks to nothing at the middle and grows again.
  auto motion = std::make_shared<SceneMotion>();
  KeyedTransform keys;
  keys.stretch = {.times = {0, 0.5, 1}, .values = {glm::dmat3(1), glm::dmat3(0), glm::dmat3(2)}};
  motion->nodes.push_back({.keys = keys});
  for (std::size_t i = 2; i < 5; ++i)
    motion->shapes.push_back({.shape = i, .rest = scene.shapes[i].geometry, .place = {.node = 0}});
  motion->instances.push_back({0, {.node = 0}});
  scene.motion = motion;
  const DeviceScene device = built(scene);
  const TableSpans& t = device.header.tables;
  EXPECT_EQ(t.instance_motions.count, 2);
  EXPECT_EQ(t.triangle_motions.count, 12);
  EXPECT_EQ(t.quadric_motions.count, 1);
  const Scene s = kernel_scene(device);
  for (int i = 0; i < t.instance_states.count; ++i) EXPECT_TRUE(std::isfinite(s.instance_states[i].at.x));
  // At the middle they are points; at the end they are as large as they should be.
  EXPECT_LT(quadric_at(&s, 0, 0.5f).radius, 1e-12f);
  EXPECT_NEAR(quadric_at(&s, 0, 1.0f).radius, 2, 1e-6);
  const TriangleState middle = triangle_at(&s, s.shutter->still_triangles, 0.5f);
  EXPECT_EQ(length3(cross3(sub(middle.p1, middle.p0), sub(middle.p2, middle.p0))), 0.0f);
  for (int i = 0; i < 2; ++i) {
    const Instance end = instance_at(&s, s.shutter->still_instances + i, 1.0f),
                   start = instance_at(&s, s.shutter->still_instances + i, 0.0f);
    EXPECT_NEAR(end.x.x / start.x.x, 2, 1e-5);
    EXPECT_LT(instance_at(&s, s.shutter->still_instances + i, 0.5f).x.x, 1e-5f);
  }
}

TEST_F(MotionTablesTest, WorkersRefuseTablesThatDoNotFit) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  const DeviceScene good =
      built(open(std::string(kStill) + "<shape type='cube'>" + light + moving("", "<translate x='1'/>") +
                     "</shape><shape type='sphere'>" + moving("", "<translate x='1'/>") + "</shape>",
                 moving("<translate z='-9'/>", "<translate z='-8'/>")));
  ASSERT_TRUE(check_device_scene(good));
  const auto expect_refused = [&](const char* what, auto table_of, auto change) {
    DeviceScene bad = good;
    const TableSpan span = table_of(bad.header.tables);
    change(bad, bad.words.data() + span.offset);
    const auto checked = check_device_scene(bad);
    EXPECT_FALSE(checked) << what;
    if (!checked) EXPECT_THAT(checked.error().message, HasSubstr(what));
  };
#define CHANGED(table, Record, change)                                                  \
  [](const TableSpans& t) { return t.table; }, [](DeviceScene&, std::uint32_t* words) { \
    auto& record = *reinterpret_cast<Record*>(words);                                   \
    change;                                                                             \
  }
  expect_refused("triangles that move do not match", CHANGED(shutter, Shutter, ++record.still_triangles));
  expect_refused("quadrics that move do not match", CHANGED(shutter, Shutter, --record.still_quadrics));
  expect_refused("instances that move do not match", CHANGED(shutter, Shutter, --record.still_instances));
  expect_refused("camera's states", CHANGED(shutter, Shutter, ++record.camera_steps));
  expect_refused("outside of the shutter's time", CHANGED(shutter, Shutter, record.exposure = 1.5f));
  expect_refused("curve without its knots", CHANGED(shutter, Shutter, record.curve_knots = 1000));
  expect_refused("curve of implausible numbers", CHANGED(shutter_curve, float, record = -1));
  expect_refused("state that is not there", CHANGED(triangle_motions, Motion, record.first = 1 << 20));
  expect_refused("state that is not there", CHANGED(instance_motions, Motion, record.stride = 1 << 20));
  expect_refused("implausible number of steps", CHANGED(triangle_motions, Motion, record.steps = 0));
  expect_refused("implausible number of steps", CHANGED(instance_motions, Motion, record.steps = 65));
  expect_refused("leaf that is not there", CHANGED(motion_nodes, MotionNode, record.child[0] = ~1000));
  expect_refused("has states that are not there", CHANGED(motion_leaves, MotionLeaf, record.last_step = 60));
  expect_refused("has states that are not there", CHANGED(motion_leaves, MotionLeaf, record.steps = 0));
  expect_refused("child that is not there", CHANGED(motion_nodes, MotionNode, record.child[0] = 1000));
  expect_refused("child that is not there", CHANGED(motion_nodes, MotionNode, record.child[0] = 0));
  expect_refused("names a primitive that does not",
                 CHANGED(motion_leaves, MotionLeaf, record.primitive[7] = 0));
  expect_refused("names an instance that does not",
                 CHANGED(motion_leaves, MotionLeaf, record.instance[7] = 9));
#undef CHANGED
  DeviceScene bad = good;
  bad.header.features &= ~std::uint64_t(FEATURE_MOTION);
  EXPECT_FALSE(check_device_scene(bad));
}

/// Points that move, with the box of each at any time.
void expect_contained(const Scene& s, int mover, bool is_instance, float time, const vec3& p, int at = 0) {
  bool inside = false;
  std::function<void(int)> visit = [&](int node) {
    const MotionNode& n = s.motion_nodes[node];
    for (int k = 0; k < BVH_WIDTH && !inside; ++k) {
      if (time < n.begin[k] || time > n.end[k]) continue;
      const float c[3] = {p.x, p.y, p.z};
      bool in_box = true;
      for (int axis = 0; axis < 3; ++axis)
        in_box = in_box && n.low[axis][k] + time * n.low_speed[axis][k] <= c[axis] &&
                 c[axis] <= n.high[axis][k] + time * n.high_speed[axis][k];
      if (!in_box) continue;
      if (n.child[k] >= 0) {
        visit(n.child[k]);
        continue;
      }
      const MotionLeaf& leaf = s.motion_leaves[~n.child[k]];
      for (int j = 0; j < BVH_WIDTH; ++j)
        inside = inside || (is_instance ? leaf.instance[j] : leaf.primitive[j]) == mover;
    }
  };
  visit(at);
  EXPECT_TRUE(inside) << "mover " << mover << " at time " << time;
}

TEST_F(MotionTablesTest, BoxesHoldWhatMoves) {
  const std::string light = "<emitter type='area'><rgb name='radiance' value='2'/></emitter>";
  std::string inside = kStill;
  for (int i = 0; i < 12; ++i) {
    const std::string x = std::to_string(7 * i), turn = std::to_string(30 * i);
    inside += "<shape type='cube'>" + (i % 2 == 0 ? light : "") +
              moving("<translate y='" + x + "'/>",
                     "<rotate z='1' y='2' angle='" + turn + "'/><translate x='40' y='-" + x + "'/>") +
              "</shape><shape type='sphere'>" + (i % 2 == 0 ? light : "") +
              moving("<translate z='" + x + "'/>", "<scale value='2'/><translate x='" + x + "'/>") +
              "</shape>";
  }
  const DeviceScene device = built(open(inside));
  const TableSpans& t = device.header.tables;
  ASSERT_EQ(t.triangle_motions.count, 6 * 12);
  ASSERT_EQ(t.quadric_motions.count, 6);
  ASSERT_EQ(t.instance_motions.count, 12);
  const Scene s = kernel_scene(device);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int trial = 0; trial < 1000; ++trial) {
    const float time = trial < 9 ? float(trial) / 8 : unit(random);
    const int triangle = s.shutter->still_triangles + int(random() % unsigned(t.triangle_motions.count));
    const TriangleState state = triangle_at(&s, triangle, time);
    for (const vec3& p : {state.p0, state.p1, state.p2}) expect_contained(s, triangle, false, time, p);
    const int quadric = s.shutter->still_quadrics + int(random() % unsigned(t.quadric_motions.count));
    const Quadric q = quadric_at(&s, quadric, time);
    for (int axis = 0; axis < 3; ++axis) {
      vec3 d = make_vec3(0, 0, 0);
      (axis == 0 ? d.x : axis == 1 ? d.y : d.z) = trial % 2 == 0 ? q.radius : -q.radius;
      expect_contained(s, t.triangles.count + quadric, false, time, add(q.center, d));
    }
    const int instance = s.shutter->still_instances + int(random() % unsigned(t.instance_motions.count));
    const Instance i = instance_at(&s, instance, time);
    const PrimitiveGroup group = s.groups[i.group];
    for (int f = 0; f < group.triangle_count; ++f)
      expect_contained(s, instance, true, time,
                       from_group_point(i, s.triangles[group.first_triangle + f].p0));
    for (int f = 0; f < group.quadric_count; ++f) {
      const Quadric& sphere = s.quadrics[group.first_quadric + f];
      expect_contained(s, instance, true, time,
                       from_group_point(i, add(sphere.center, make_vec3(0, sphere.radius, 0))));
    }
  }
}

}  // namespace
}  // namespace penumbra
