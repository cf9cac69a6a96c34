// Motion of every size and at every time.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kernels/host/flagged_samples.h"
#include "scenes/motion/exposed_motion.h"
#include "tests/acceptance/motion_pieces.h"

namespace penumbra::motion_extremes_test {
namespace {

using namespace motion_pieces;
using glm::dvec3;

/// What moves: by its matrix, by its vertices, or by its record.
enum class Kind { kRigid, kInstance, kEmitter, kSphere, kRoundEmitter, kDisk };
constexpr Kind kKinds[] = {Kind::kRigid,  Kind::kInstance,     Kind::kEmitter,
                           Kind::kSphere, Kind::kRoundEmitter, Kind::kDisk};
std::string name_of(Kind kind) {
  return std::vector<std::string>{
      "Rigid", "Instance", "Emitter", "Sphere", "RoundEmitter", "Disk"}[std::size_t(kind)];
}
SceneDescription with_thing(Kind kind, const std::function<int(Mover&)>& node) {
  const std::string glow = "<emitter type='area'><rgb name='radiance' value='2 3 4'/></emitter>";
  const std::string group = "<shape type='shapegroup' id='group'>" + cube(kGrey) +
                            "</shape><shape type='instance'><ref id='group'/></shape>";
  const auto round = [](const std::string& type, const std::string& inside) {
    return "<shape type='" + type + "'><transform name='to_world'><scale value='0.7'/>" +
           (type == "disk" ? "<rotate y='1' angle='180'/>" : "") + "</transform>" + inside + "</shape>";
  };
  const std::string things[] = {
      cube(kGrey), group, cube(glow), round("sphere", kGrey), round("sphere", glow), round("disk", glow)};
  SceneDescription scene = scene_of(things[int(kind)]);
  Mover move(scene);
  const int moves = node(move);
  if (kind == Kind::kInstance)
    move.instance(0, moves);
  else
    move.last_shape(moves);
  return scene;
}

class MotionExtremes : public testing::TestWithParam<Kind> {};

const dvec3 kWay(0.9, 0.4, -0.3);
KeyedTransform keyed(std::vector<double> times, std::vector<dvec3> places) {
  KeyedTransform keys;
  keys.translation = {.times = std::move(times), .values = std::move(places)};
  return keys;
}

TEST_P(MotionExtremes, ShutterThatNeverOpensIsAStill) {
  SceneDescription scene = with_thing(GetParam(), [](Mover& m) { return m.node(kWay, 30); });
  scene.camera.shutter = 0.0f;
  scene.sampler.spp = 4;
  ASSERT_TRUE(set_time(scene, 0.3));
  const DeviceScene device = build_or_throw(scene);
  EXPECT_EQ(device.header.features & FEATURE_MOTION, 0u);
  const std::uint64_t hash = render_or_throw(device).hash();
  scene.motion = nullptr;
  EXPECT_EQ(render_or_throw(scene).hash(), hash);
}

TEST_P(MotionExtremes, KeysBeforeAndAfterTheExposureAreAStill) {
  for (const double first : {-3.0, 1.5}) {
    SceneDescription scene = with_thing(GetParam(), [&](Mover& m) {
      return m.node(keyed({first, first + 1}, {dvec3(0), kWay}));
    });
    ASSERT_TRUE(set_time(scene, 0));
    scene.sampler.spp = 4;
    const DeviceScene device = build_or_throw(scene);
    EXPECT_EQ(device.header.features & FEATURE_MOTION, 0u);
    const std::uint64_t hash = render_or_throw(device).hash();
    scene.motion = nullptr;
    EXPECT_EQ(render_or_throw(scene).hash(), hash);
  }
}

TEST_P(MotionExtremes, KeysBeyondTheExposure) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({-4, 5}, {-4.0 * kWay, 5.0 * kWay}));
  }));
}

TEST_P(MotionExtremes, KeysThatEndWithinTheExposure) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({-0.5, 0.4}, {dvec3(-0.5, 0, 0), kWay}));
  }));
}

TEST_P(MotionExtremes, CrossesTheSceneWithinTheFrame) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({0, 1}, {dvec3(-25, 0, 1), dvec3(25, 1, 0)}));
  }));
}

TEST_P(MotionExtremes, MovesByNearlyNothing) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({0, 1}, {dvec3(0), dvec3(1e-7)}));
  }));
}

TEST_P(MotionExtremes, MovesFarAway) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({0, 1}, {dvec3(0), dvec3(1e7, 2e6, -1e6)}));
  }));
}

TEST_P(MotionExtremes, ComesFromFarAway) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    return m.node(keyed({0, 1}, {dvec3(1e7, 2e6, 3e6), dvec3(0)}));
  }));
}

TEST_P(MotionExtremes, TurnsTwice) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    std::vector<TransformKey> keys;
    for (int k = 0; k <= 16; ++k)
      keys.push_back({k / 16.0, glm::rotate(glm::dmat4(1), glm::radians(45.0 * k), {0.2, 1, 0.1})});
    return m.node(keys);
  }));
}

TEST_P(MotionExtremes, TenTurnsAreWarnedOf) {
  SceneDescription scene = with_thing(GetParam(), [](Mover& m) {
    std::vector<TransformKey> keys;
    for (int k = 0; k <= 80; ++k)
      keys.push_back({k / 80.0, glm::rotate(glm::dmat4(1), glm::radians(45.0 * k), {0, 0.2, 1})});
    return m.node(keys);
  });
  ASSERT_TRUE(set_time(scene, 0));
  const auto motion = exposed_motion(scene);
  ASSERT_TRUE(motion) << motion.error().message;
  const bool turns_onto_itself = GetParam() == Kind::kRoundEmitter;
  EXPECT_EQ(motion->warnings.empty(), turns_onto_itself);
  scene.sampler.spp = 16;
  EXPECT_EQ(non_finite_count(render_or_throw(scene).flagged()), 0u);
}

TEST_P(MotionExtremes, VanishesAtTheEnd) {
  for (const bool at_end : {true, false}) {
    SCOPED_TRACE(at_end);
    expect_mean_of_stills(with_thing(GetParam(), [&](Mover& m) {
      KeyedTransform keys = keyed({0, 1}, {dvec3(0), kWay});
      keys.stretch = {.times = {0, 1}, .values = {glm::dmat3(at_end ? 1 : 0), glm::dmat3(at_end ? 0 : 1)}};
      return m.node(keys);
    }));
  }
}

TEST_P(MotionExtremes, IsMirrored) {
  expect_mean_of_stills(with_thing(GetParam(), [](Mover& m) {
    KeyedTransform keys = keyed({0, 1}, {dvec3(0), kWay});
    const auto mirror = [](double size) { return size * glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1); };
    keys.stretch = {.times = {0, 1}, .values = {mirror(1), mirror(0.6)}};
    return m.node(keys);
  }));
}

/// A jump cannot be followed; the blur of it lasts for a step of the finest.
TEST(MotionJump, IsBlurredForAStepAtMost) {
  SceneDescription scene = pixel_world(10, 1, 4096);
  scene.shapes.push_back(rectangle({1, -1, 0}, 2, 3, kBlackBsdf, 1.0f));
  {
    Mover move(scene);
    KeyedTransform keys = keyed({0, 0.37}, {dvec3(0), dvec3(5, 0, 0)});
    keys.translation.interpolation = Interpolation::kStep;
    move.last_shape(move.node(keys));
  }
  const auto motion = exposed_motion(scene);
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_FALSE(motion->warnings.empty());
  const FilmAccumulator film = render_or_throw(scene);
  for (int x = 0; x < 10; ++x) {
    const double share = x == 1 || x == 2 ? 0.37 : x == 6 || x == 7 ? 0.63 : 0;
    const Moments m{.mean = share, .variance = share * (1 - share)};
    EXPECT_NEAR(film.at(x, 0).mean[0], share, bernstein(m, 1, 4096, kSignificance / 10) + 1.0 / kFinestSteps)
        << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Things, MotionExtremes, testing::ValuesIn(kKinds),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace penumbra::motion_extremes_test
