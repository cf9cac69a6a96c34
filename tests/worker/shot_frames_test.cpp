// Device scenes of the frames of a shot: what is still has the same tables in all of them, and a frame does
// not depend on others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scenes/matte_names.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/transform.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"
#include "tests/worker/built_scenes.h"
#include "tests/worker/device_scenes.h"

namespace penumbra::shot_frames_test {
namespace {

using glm::dvec3;

/// From the first to the second second it is moved, and its size is multiplied.
KeyedTransform travel(const dvec3& way, double size = 1) {
  KeyedTransform keys;
  keys.translation = {Interpolation::kLinear, {0.0, 1.0}, {dvec3(0), way}};
  keys.stretch = {Interpolation::kLinear, {0.0, 1.0}, {glm::dmat3(1.0), glm::dmat3(size)}};
  return keys;
}

/// A scene to which motion is given part by part.
struct Shot {
  SceneDescription scene;
  SceneMotion motion = {};

  int add_node(const KeyedTransform& keys) {
    motion.nodes.push_back({.keys = keys});
    return int(motion.nodes.size()) - 1;
  }
  Shot& move_shape(std::size_t shape, const KeyedTransform& keys, int group = -1) {
    const Shape& its =
        group < 0 ? scene.shapes.at(shape) : scene.groups.at(std::size_t(group)).shapes.at(shape);
    motion.shapes.push_back(
        {.group = group, .shape = shape, .rest = its.geometry, .place = {.node = add_node(keys)}});
    return *this;
  }
  Shot& move_instance(std::size_t instance, const KeyedTransform& keys) {
    motion.instances.push_back({instance, {add_node(keys), scene.instances.at(instance).to_world}});
    return *this;
  }
  /// The description at a time, moved there from another one.
  [[nodiscard]] SceneDescription at(double time) const {
    SceneDescription frame = scene;
    frame.motion = std::make_shared<SceneMotion>(motion);
    for (const double t : {0.7, time})
      if (const auto posed = set_time(frame, t); !posed) throw std::runtime_error(posed.error().message);
    return frame;
  }
  /// The same without motion.
  [[nodiscard]] SceneDescription still_at(double time) const {
    SceneDescription frame = at(time);
    frame.motion = nullptr;
    return frame;
  }
};

/// A ball of triangles in the middle of the box.
Shape ball(int bsdf, std::optional<float> radiance = std::nullopt) {
  constexpr int kAround = 24, kDown = 12;
  std::vector<dvec3> corners;
  const auto at = [](int i, int j) {
    const double polar = std::numbers::pi * i / kDown, azimuth = 2 * std::numbers::pi * j / kAround;
    return 0.25 *
           dvec3(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
  };
  for (int i = 0; i < kDown; ++i)
    for (int j = 0; j < kAround; ++j)
      corners.insert(corners.end(),
                     {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
  Shape made = triangles(corners, bsdf, radiance);
  made.back_bsdf = bsdf;
  made.name = "ball";
  return made;
}

Shape sphere(const dvec3& center, int bsdf) {
  Shape made;
  made.name = "sphere";
  made.geometry = Sphere{center, 0.15};
  made.front_bsdf = made.back_bsdf = bsdf;
  return made;
}

/// The box with a sheet of many triangles and a sphere, in which a ball, a light and a sphere move.
Shot moving_shapes_in_a_box() {
  Shot shot{.scene = many_triangles()};
  std::vector<Shape>& shapes = shot.scene.shapes;
  shapes.push_back(sphere(dvec3(-0.6, 0.4, 0), 0));
  const std::size_t first = shapes.size();
  shapes.push_back(ball(0));
  shapes.push_back(ball(kBlackBsdf, 3.0f));
  shapes.push_back(sphere(dvec3(0.2, 0.2, 0.3), 0));
  shot.move_shape(first, travel(dvec3(0.5, 0.3, 0.2)));
  shot.move_shape(first + 1, travel(dvec3(-0.5, 0.5, 0), 0.5));
  shot.move_shape(first + 2, travel(dvec3(0.2, 0.1, 0)));
  return shot;
}

/// Instances of which one moves, and a group that deforms.
Shot moving_instances_in_a_box() {
  Shot shot{.scene = instances()};
  shot.scene.groups.push_back({"balls", {ball(0)}, {}});
  shot.scene.instances.push_back({"balls", 2, translation({0.3, 0.3, 0.3})});
  shot.scene.shapes.push_back(ball(0));
  shot.move_shape(shot.scene.shapes.size() - 1, travel(dvec3(-0.4, 0.2, 0)));
  shot.move_instance(2, travel(dvec3(0.1, 0.3, 0)));
  shot.move_shape(0, travel(dvec3(0), 0.5), 2);
  return shot;
}

DeviceScene build_after(const SceneDescription& scene, const DeviceScene* earlier) {
  auto built = build_device_scene(scene, {.intersector = IntersectorChoice::kPortable, .earlier = earlier});
  if (!built) throw std::runtime_error(built.error().message);
  return std::move(*built);
}

void expect_same(const DeviceScene& a, const DeviceScene& b, const std::string& what) {
  EXPECT_EQ(std::memcmp(&a.header, &b.header, sizeof a.header), 0) << what;
  EXPECT_TRUE(a.words == b.words) << what;
}

/// The records from `first` on, `count` of them, are equal.
template <typename Record>
void expect_equal(const DeviceScene& a, const DeviceScene& b, TableSpan TableSpans::*span, int first,
                  int count, const char* what) {
  const auto one = table<Record>(a, a.header.tables.*span), other = table<Record>(b, b.header.tables.*span);
  ASSERT_LE(std::size_t(count), std::min(one.size(), other.size())) << what;
  EXPECT_EQ(
      std::memcmp(one.data() + first, other.data() + first, std::size_t(count - first) * sizeof(Record)), 0)
      << what;
}

using MakeShot = Shot (*)();
constexpr MakeShot kShots[] = {moving_shapes_in_a_box, moving_instances_in_a_box};
constexpr double kTimes[] = {0, 0.25, 1};

TEST(ShotFrames, TablesBeginWithWhatIsStill) {
  for (const MakeShot make : kShots) {
    const Shot shot = make();
    const DeviceScene a = build(shot.at(kTimes[0]));
    ASSERT_GT(a.still.nodes, 1);
    ASSERT_GT(a.still.triangles, 30);
    for (const double time : {kTimes[1], kTimes[2]}) {
      const DeviceScene b = build(shot.at(time));
      EXPECT_EQ(a.still.nodes, b.still.nodes);
      EXPECT_EQ(a.still.triangles, b.still.triangles);
      EXPECT_EQ(a.still.instances, b.still.instances);
      EXPECT_NE(a.words, b.words);
      // The root has the bounds of what moves.
      expect_equal<BvhNode>(a, b, &TableSpans::nodes, 1, a.still.nodes, "nodes");
      expect_equal<TriangleLeaf>(a, b, &TableSpans::triangle_leaves, 0, a.still.triangle_leaves, "leaves");
      expect_equal<QuadricLeaf>(a, b, &TableSpans::quadric_leaves, 0, a.still.quadric_leaves,
                                "quadric leaves");
      expect_equal<Triangle>(a, b, &TableSpans::triangles, 0, a.still.triangles, "triangles");
      expect_equal<Quadric>(a, b, &TableSpans::quadrics, 0, a.still.quadrics, "quadrics");
      expect_equal<Instance>(a, b, &TableSpans::instances, 0, a.still.instances, "instances");
      const int normals = a.header.tables.normals.count;
      expect_equal<VertexNormals>(a, b, &TableSpans::normals, 0, normals, "normals");
    }
  }
}

TEST(ShotFrames, AFrameHasTheSameBytesWhateverWasBuiltBefore) {
  const DeviceScene other = build(everything_in_a_hierarchy());
  for (const MakeShot make : kShots) {
    const Shot shot = make();
    std::vector<DeviceScene> alone;
    for (const double time : kTimes) alone.push_back(build_after(shot.at(time), nullptr));
    for (std::size_t i = 0; i < std::size(kTimes); ++i) {
      for (const DeviceScene& earlier : alone)
        expect_same(build_after(shot.at(kTimes[i]), &earlier), alone[i], "after another frame");
      expect_same(build_after(shot.at(kTimes[i]), &other), alone[i], "after another scene");
    }
    // A still shape elsewhere is not taken for the one before.
    Shot changed = shot;
    std::get<Mesh>(changed.scene.shapes.front().geometry).positions[0].y += 0.01;
    expect_same(build_after(changed.at(1), &alone[2]), build(changed.at(1)), "after a changed scene");
  }
}

/// All shapes are within the still box, so that both scenes have the same centre, and what moves is last, so
/// that primitives have the same numbers.
TEST(ShotFrames, TwoTreesShowWhatOneShows) {
  const Shot shot = moving_shapes_in_a_box();
  for (const double time : kTimes) {
    const DeviceScene two = build(shot.at(time)), one = build(shot.still_at(time));
    EXPECT_GT(two.still.nodes, 1);
    EXPECT_EQ(one.still.nodes, 0);
    EXPECT_EQ(render_or_throw(two).hash(), render_or_throw(one).hash()) << time;
  }
}

/// Here primitives have other numbers, which decides only between hits at the same distance.
TEST(ShotFrames, InstancesInTwoTreesAreWhereTheyAreInOne) {
  const Shot shot = moving_instances_in_a_box();
  for (const double time : kTimes)
    EXPECT_EQ(render_or_throw(build(shot.at(time))).hash(),
              render_or_throw(build(shot.still_at(time))).hash())
        << time;
}

/// Embree's choices between hits that are equally near, and at edges, depend on the order of primitives.
TEST(ShotFrames, EmbreeSeesThePrimitivesOfEachGroup) {
  constexpr int kMostDifferent = 24 * 18 / 50;
  for (const MakeShot make : kShots) {
    const Shot shot = make();
    const FilmAccumulator two = render_or_throw(build(shot.at(1), true, IntersectorChoice::kEmbree)),
                          one = render_or_throw(build(shot.still_at(1), true, IntersectorChoice::kEmbree));
    int different = 0;
    for (int y = 0; y < one.height(); ++y)
      for (int x = 0; x < one.width(); ++x) different += two.at(x, y).mean[1] != one.at(x, y).mean[1] ? 1 : 0;
    EXPECT_LE(different, kMostDifferent);
  }
}

TEST(ShotFrames, TheCentreIsThatOfWhatIsStill) {
  Shot shot{.scene = diffuse_box()};
  shot.scene.shapes.push_back(ball(0));
  const dvec3 before = scene_center(shot.still_at(0));
  shot.move_shape(shot.scene.shapes.size() - 1, travel(dvec3(50, 0, 0)));
  for (const double time : kTimes) EXPECT_EQ(scene_center(shot.at(time)), before);
  // If all moves it is that of the frame.
  Shot all{.scene = empty_scene(4, 4, 1, 1)};
  all.scene.shapes.push_back(ball(kBlackBsdf));
  all.move_shape(0, travel(dvec3(50, 0, 0)));
  EXPECT_EQ(scene_center(all.at(1)), scene_center(all.still_at(1)));
  EXPECT_NEAR(scene_center(all.at(1)).x, 50, 1e-9);
}

/// What has no size at the second 1 is as if it were not in the scene: the same picture, with every layer, on
/// every device.
void expect_vanishing(Shot shot, const std::string& what,
                      const std::function<void(SceneDescription&)>& take) {
  shot.scene.film.layers = {AskedLayer::kPosition, AskedLayer::kShape};
  SceneDescription without = shot.still_at(1);
  take(without);
  const DeviceScene vanished = build(shot.at(1)), there = build(shot.at(0));
  const FilmAccumulator film = render_or_throw(vanished);
  EXPECT_EQ(film.hash(), render_or_throw(build(without)).hash()) << what;
  EXPECT_NE(film.hash(), render_or_throw(there).hash()) << what;
  EXPECT_EQ(film.hash(), render_or_throw(vanished, opencl_device()).hash()) << what;
  expect_same(build_after(shot.at(0), &vanished), there, what);
  expect_same(build_after(shot.at(1), &there), vanished, what);
}

TEST(ShotFrames, MeshesSpheresAndTheirLightMayVanish) {
  const KeyedTransform shrink = travel(dvec3(0.1, 0, 0), 0);
  for (const auto& [base, name] : {std::pair(&diffuse_box, "few"), std::pair(&many_triangles, "many")})
    for (const auto& [kind, shape] : {std::pair("ball", ball(0)), std::pair("lamp", ball(kBlackBsdf, 3.0f)),
                                      std::pair("sphere", sphere(dvec3(0.2), 0))}) {
      Shot shot{.scene = base()};
      shot.scene.shapes.push_back(shape);
      shot.move_shape(shot.scene.shapes.size() - 1, shrink);
      // An empty mesh keeps the numbers of shapes.
      expect_vanishing(shot, std::string(kind) + " among " + name,
                       [](SceneDescription& scene) { scene.shapes.back().geometry = Mesh{}; });
    }
}

TEST(ShotFrames, TheOnlyLightMayVanish) {
  Shot shot{.scene = many_triangles()};
  const auto light =
      std::ranges::find_if(shot.scene.shapes, [](const Shape& shape) { return bool(shape.radiance); });
  shot.move_shape(std::size_t(light - shot.scene.shapes.begin()), travel(dvec3(0), 0));
  const FilmAccumulator dark = render_or_throw(build(shot.at(1)));
  for (int x = 0; x < dark.width(); ++x) EXPECT_EQ(dark.at(x, 5).mean[0], 0);
}

TEST(ShotFrames, InstancesMayVanish) {
  // One of several; the only one of its group.
  Shot shot{.scene = instances()};
  shot.move_instance(2, travel(dvec3(0), 0));
  expect_vanishing(shot, "one instance",
                   [](SceneDescription& scene) { scene.instances.erase(scene.instances.begin() + 2); });
  Shot only{.scene = instances()};
  only.scene.groups.push_back({"ball", {ball(0)}, {}});
  only.scene.instances.push_back({"ball", 2, glm::dmat4(1.0)});
  only.move_instance(only.scene.instances.size() - 1, travel(dvec3(0), 0));
  expect_vanishing(only, "the only instance of a group",
                   [](SceneDescription& scene) { scene.instances.pop_back(); });
  // The only one of all, of a group that is large, deforms, or emits.
  for (const bool deforms : {false, true})
    for (const std::optional<float> radiance : {std::optional<float>(), std::optional(3.0f)}) {
      Shot last{.scene = many_triangles()};
      last.scene.groups.push_back({"ball", {ball(0, radiance)}, {}});
      last.scene.instances.push_back({"ball", 0, translation({0.2, 0, 0})});
      if (deforms)
        last.move_shape(0, travel(dvec3(0), 0), 0);
      else
        last.move_instance(0, travel(dvec3(0), 0));
      expect_vanishing(last, "the last instance", [](SceneDescription& scene) { scene.instances.clear(); });
    }
}

/// A hidden group has triangles, and the one that is seen has none at all.
TEST(ShotFrames, AHiddenGroupBesideOneWithoutAreaIsNotSeen) {
  Shot shot{.scene = many_triangles()};
  const dvec3 flat[] = {dvec3(0), dvec3(0.1, 0, 0), dvec3(0.2, 0, 0)};
  shot.scene.groups = {{"ball", {ball(0)}, {}}, {"flat", {triangles(flat, 0)}, {}}};
  shot.scene.instances = {{"ball", 0, translation({0.2, 0, 0})}, {"flat", 1, glm::dmat4(1.0)}};
  shot.move_instance(0, travel(dvec3(0), 0));
  expect_vanishing(shot, "a hidden group",
                   [](SceneDescription& scene) { scene.instances.erase(scene.instances.begin()); });
}

TEST(ShotFrames, EverythingMayVanish) {
  Shot shot{.scene = empty_scene(8, 8, 4, 1)};
  shot.scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.5f)});
  shot.scene.shapes.push_back(ball(kBlackBsdf));
  shot.move_shape(0, travel(dvec3(0), 0));
  const FilmAccumulator film = render_or_throw(build(shot.at(1)));
  EXPECT_FLOAT_EQ(float(film.at(4, 4).mean[0]), 0.5f);
}

TEST(ShotFrames, BordersOfMediaMayVanish) {
  Shot shot{.scene = many_triangles()};
  shot.scene.media.push_back(
      {.name = "fog", .extinction = glm::vec3(3), .albedo = glm::vec3(0.8f), .phase = {{PHASE_HG, 0.4f, 1}}});
  shot.scene.bsdfs.push_back({"nothing", NullBsdf{}});
  const int nothing = int(shot.scene.bsdfs.size()) - 1;
  for (int i = 0; i < 2; ++i) {
    shot.scene.shapes.push_back(sphere(dvec3(0.2 - 0.5 * i, 0.1, 0.3), nothing));
    shot.scene.shapes.back().interior = 0;
  }
  shot.scene.integrator.method = VolpathIntegrator{};
  shot.move_shape(shot.scene.shapes.size() - 1, travel(dvec3(0), 0));
  expect_vanishing(shot, "fog", [](SceneDescription& scene) { scene.shapes.back().geometry = Mesh{}; });
}

TEST(ShotFrames, ShapesAndMattesKeepTheNumbersOfTheDescription) {
  Shot shot{.scene = many_triangles()};
  shot.scene.shapes.insert(shot.scene.shapes.begin(), ball(0));
  shot.move_shape(0, travel(dvec3(0.5, 0.3, 0.2)));
  shot.scene.film.layers = {AskedLayer::kShape};
  MatteNames moving, still;
  for (const double time : kTimes) {
    auto a = build_device_scene(shot.at(time), {.mattes = &moving}),
         b = build_device_scene(shot.still_at(time), {.mattes = &still});
    ASSERT_TRUE(a && b);
    EXPECT_EQ(moving.objects, still.objects);
    EXPECT_EQ(moving.mattes.size(), still.mattes.size());
    const auto shapes = table<int>(*a, a->header.tables.primitive_shapes),
               mattes = table<int>(*a, a->header.tables.mattes);
    const auto its = table<int>(*b, b->header.tables.primitive_shapes),
               theirs = table<int>(*b, b->header.tables.mattes);
    // The moving ball's are last here and first there.
    const auto n = std::size_t(a->header.tables.triangles.count - a->still.triangles);
    ASSERT_EQ(shapes.size(), its.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const std::size_t j = (i + n) % shapes.size();
      ASSERT_EQ(shapes[i], its[j]);
      ASSERT_EQ(mattes[i], theirs[j]);
    }
  }
}

}  // namespace
}  // namespace penumbra::shot_frames_test
