// Layers and mattes of what moves, and the layer of motion, against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "kernels/host/flagged_samples.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/matte_names.h"
#include "scenes/motion/exposed_motion.h"
#include "scenes/motion/exposure.h"
#include "tests/acceptance/motion_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::motion_layers_test {
namespace {

using namespace motion_pieces;
using glm::dvec2, glm::dvec3;

constexpr std::uint32_t kSpp = 1024;

using Value = std::function<double(double x, double y, double time)>;

/// A channel of a layer, of values in a range.
struct Channel {
  std::string name;
  int layer = 0, plane = 0;
  Value value;
  double range = 1;
};

enum class Shape2d { kHasEdges, kIsSmooth };

/// Each pixel's mean of each channel, in all of the scenes. `deviation`: of paths, in pixels; `rounding`: of
/// a value.
void expect_layers(const std::vector<SceneDescription>& scenes, const std::vector<Channel>& channels,
                   Shape2d shape = Shape2d::kHasEdges, double deviation = 0, double rounding = 1e-4) {
  std::vector<FilmAccumulator> films;
  for (const SceneDescription& scene : scenes) {
    films.push_back(render_or_throw(scene));
    EXPECT_EQ(non_finite_count(films.back().flagged()), 0u);
  }
  const int width = films[0].width(), height = films[0].height();
  const double each = statistics::sidak_significance(
      kSignificance, films.size() * channels.size() * std::size_t(width * height));
  double worst = 0;
  for (const Channel& c : channels)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Moments m = shape == Shape2d::kIsSmooth ? moments_of_smooth(x, y, c.value)
                                                      : moments(x, y, c.value, deviation, c.range);
        const double limit = bernstein(m, c.range, kSpp, each) + m.allowance + rounding * c.range;
        for (std::size_t i = 0; i < films.size(); ++i) {
          const double found = films[i].layer(x, y, c.layer, c.plane);
          EXPECT_NEAR(found, m.mean, limit) << c.name << " of pixel " << x << ", " << y << " of scene " << i;
          worst = std::max(worst, std::abs(found - m.mean) / limit);
        }
      }
  testing::Test::RecordProperty("worst", std::to_string(worst) + " of the limit");
}

/// A grey square with texture coordinates that passes a whiter wall. It moves along the axes and away.
struct Passing {
  static constexpr double kLeft = 1.2, kTop = 1.6, kSize = 3, kWall = 8;
  static constexpr float kAlbedo = 0.25f, kWallAlbedo = 0.75f;
  dvec3 way{5.3, 2.1, 4};
  [[nodiscard]] dvec2 place(double x, double y, double t) const {
    return (dvec2(x, y) - dvec2(kLeft, kTop) - t * dvec2(way)) / kSize;
  }
  [[nodiscard]] bool is_there(double x, double y, double t) const {
    const dvec2 p = place(x, y, t);
    return p.x > 0 && p.y > 0 && p.x < 1 && p.y < 1;
  }

  [[nodiscard]] SceneDescription scene(bool emits) const {
    SceneDescription scene = pixel_world(12, 8, kSpp);
    const int wall = add_diffuse(scene, kWallAlbedo), grey = add_diffuse(scene, kAlbedo);
    scene.bsdfs[0].name = "white", scene.bsdfs[1].name = "grey";
    scene.shapes.push_back(rectangle({-50, -50, kWall}, 100, 100, wall));
    scene.shapes[0].name = "wall";
    Shape square =
        rectangle({kLeft, kTop, 0}, kSize, kSize, grey, emits ? std::optional(0.5f) : std::nullopt);
    square.name = "square";
    auto& mesh = std::get<Mesh>(square.geometry);
    for (const dvec3& p : mesh.positions)
      mesh.texcoords.emplace_back(glm::vec2((dvec2(p) - dvec2(kLeft, kTop)) / kSize));
    scene.shapes.push_back(square);
    scene.film.layers = {AskedLayer::kPosition, AskedLayer::kUv, AskedLayer::kGeometricNormal};
    Mover move(scene);
    move.last_shape(move.node(way));
    return scene;
  }
};

TEST(MotionLayers, AreMeansOverTheExposure) {
  const Passing passing;
  const auto either = [&](auto of_square, auto of_wall) {
    return [=](double x, double y, double t) {
      return passing.is_there(x, y, t) ? of_square(x, y, t) : of_wall(x, y, t);
    };
  };
  const auto constant = [](double value) { return [=](double, double, double) { return value; }; };
  const auto away = [&](double, double, double t) { return t * passing.way.z; };
  constexpr double kCamera = 10;
  const std::vector<Channel> channels{
      {"albedo", LAYER_ALBEDO, 0, either(constant(Passing::kAlbedo), constant(Passing::kWallAlbedo))},
      {"normal", LAYER_NORMAL, 2, constant(-1)},
      {"geometric normal", LAYER_GEOMETRIC_NORMAL, 2, constant(-1)},
      {"depth", LAYER_DEPTH, 0,
       either([&](double, double, double t) { return kCamera + t * passing.way.z; },
              constant(kCamera + Passing::kWall)),
       Passing::kWall},
      {"x", LAYER_POSITION, 0, [](double x, double, double) { return x; }},
      {"y", LAYER_POSITION, 1, [](double, double y, double) { return y; }},
      {"z", LAYER_POSITION, 2, either(away, constant(Passing::kWall)), Passing::kWall},
  };
  expect_layers({passing.scene(false), passing.scene(true)}, channels);
}

TEST(MotionLayers, TextureCoordinatesMoveWithTheShape) {
  const Passing passing;
  std::vector<SceneDescription> scenes;
  for (const bool emits : {false, true}) {
    scenes.push_back(passing.scene(emits));
    scenes.back().shapes.erase(scenes.back().shapes.begin());
    Mover move(scenes.back());
    move.last_shape(move.node(passing.way));
  }
  std::vector<Channel> channels;
  for (const int i : {0, 1})
    channels.push_back({i == 0 ? "u" : "v", LAYER_UV, i, [&passing, i](double x, double y, double t) {
                          return passing.is_there(x, y, t) ? passing.place(x, y, t)[i] : 0.0;
                        }});
  channels.push_back({"alpha", LAYER_COVERAGE, 0, [&passing](double x, double y, double t) {
                        return passing.is_there(x, y, t) ? 1.0 : 0.0;
                      }});
  expect_layers(scenes, channels);
}

TEST(MotionLayers, MattesHaveTheShareOfTheTime) {
  const Passing passing;
  for (const bool emits : {false, true}) {
    const SceneDescription description = passing.scene(emits);
    MatteNames names;
    DeviceSceneOptions options;
    options.intersector = IntersectorChoice::kPortable;
    options.mattes = &names;
    const auto scene = build_device_scene(description, options);
    ASSERT_TRUE(scene) << scene.error().message;
    const FilmAccumulator film = render_or_throw(*scene);
    const double each = statistics::sidak_significance(kSignificance, 12 * 8);
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 12; ++x) {
        std::map<std::string, double> shares;
        for (const MatteWeight& matte : film.mattes(x, y))
          shares[names.objects[names.mattes[std::size_t(matte.matte) - 1].object]] +=
              matte.weight / double(film.at(x, y).count);
        const Moments m = moments(
            x, y, [&](double u, double v, double t) { return passing.is_there(u, v, t) ? 1.0 : 0.0; });
        EXPECT_NEAR(shares["square"], m.mean, bernstein(m, 1, kSpp, each) + m.allowance) << x << ',' << y;
        EXPECT_DOUBLE_EQ(shares["square"] + shares["wall"], 1.0) << "nothing is lost";
      }
  }
}

/// The layer of motion: a thing whose point `p` of the middle of the frame is elsewhere at other times.
struct Mover2d {
  /// Where the film shows at `time` what is at `p` at the time 0.
  std::function<dvec2(dvec2, double)> path;
  /// The point at the time 0 of what is at the film's position at `time`; NaN: nothing is there.
  std::function<dvec2(dvec2, double)> from;
};

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

/// Frames last 1, and the frame that is shown begins at 0.
void expect_motion(std::vector<SceneDescription> scenes, const Mover2d& thing, double range, double deviation,
                   Shape2d shape = Shape2d::kHasEdges) {
  for (const double shutter : {0.0, 0.5}) {
    SCOPED_TRACE(shutter);
    for (SceneDescription& scene : scenes) {
      scene.film.layers = {AskedLayer::kMotion};
      scene.camera.shutter = float(shutter);
      ASSERT_TRUE(set_time(scene, 0));
    }
    const Exposure exposure = exposure_of(scenes[0]);
    const std::array times{exposure.before, exposure.after};
    std::vector<Channel> channels;
    for (int frame = 0; frame < 2; ++frame)
      for (int axis = 0; axis < 2; ++axis)
        channels.push_back({std::string(1, "XYZW"[2 * frame + axis]),
                            frame == 0 ? LAYER_MOTION_BEFORE : LAYER_MOTION_AFTER, axis,
                            [&, frame, axis](double x, double y, double t) {
                              const dvec2 p = thing.from({x, y}, exposure.open + t * shutter);
                              if (std::isnan(p.x)) return 0.0;
                              return (thing.path(p, times[std::size_t(frame)]) -
                                      thing.path(p, exposure.middle()))[axis];
                            },
                            range});
    // The middle is off its path, and so is what the pixel shows.
    expect_layers(scenes, channels, shape, shutter > 0 ? deviation : 0,
                  1e-4 + (shutter > 0 ? deviation / range : 0));
  }
}

/// Keys of a path, from two frames before to three after.
std::vector<TransformKey> keys_of(const std::function<glm::dmat4(double)>& path) {
  std::vector<TransformKey> keys;
  for (int k = -20; k <= 30; ++k) keys.push_back({k / 10.0, path(k / 10.0)});
  return keys;
}

Mover2d translating(dvec2 low, dvec2 high, dvec2 speed) {
  return {[=](dvec2 p, double t) { return p + t * speed; },
          [=](dvec2 p, double t) {
            const dvec2 q = p - t * speed;
            return q.x > low.x && q.y > low.y && q.x < high.x && q.y < high.y ? q : dvec2(kNever);
          }};
}

TEST(LayerOfMotion, OfAnObjectThatMoves) {
  const dvec2 low(2.2, 1.7), speed(3.1, -1.2);
  constexpr double kSize = 4;
  std::vector<SceneDescription> scenes;
  for (const bool emits : {false, true}) {
    SceneDescription& scene = scenes.emplace_back(pixel_world(12, 8, kSpp));
    scene.shapes.push_back(
        rectangle({low, 0}, kSize, kSize, kBlackBsdf, emits ? std::optional(1.0f) : std::nullopt));
    Mover move(scene);
    move.last_shape(
        move.node(keys_of([&](double t) { return glm::translate(glm::dmat4(1), dvec3(t * speed, 0)); })));
  }
  expect_motion(scenes, translating(low, low + kSize, speed), 6.2, 0);
}

TEST(LayerOfMotion, OfASphereThatMovesAndGrows) {
  // Its points move away from the centre as it grows: what is seen at p at the time t is at the same place
  // relative to the radius at other times.
  const dvec2 center(5, 4), speed(1.5, 0.8);
  constexpr double kRadius = 2.5, kGrowth = 0.4;  // a frame
  const auto center_at = [&](double t) { return center + t * speed; };
  const auto radius_at = [&](double t) { return kRadius * (1 + kGrowth * t); };
  const Mover2d thing{[&](dvec2 p, double t) { return center_at(t) + radius_at(t) * p; },
                      [&](dvec2 p, double t) {
                        const dvec2 q = (p - center_at(t)) / radius_at(t);
                        return glm::length(q) < 1 ? q : dvec2(kNever);
                      }};
  std::vector<SceneDescription> scenes;
  for (const bool emits : {false, true}) {
    SceneDescription& scene = scenes.emplace_back(pixel_world(12, 8, kSpp));
    Shape sphere;
    sphere.name = "sphere";
    sphere.geometry = Sphere{dvec3(center, 0), kRadius};
    if (emits) sphere.radiance = glm::vec3(1);
    scene.shapes.push_back(sphere);
    Mover move(scene);
    move.last_shape(move.node(keys_of([&](double t) {
      return glm::scale(glm::translate(glm::dmat4(1), dvec3(center_at(t), 0)),
                        dvec3(radius_at(t) / kRadius)) *
             glm::translate(glm::dmat4(1), -dvec3(center, 0));
    })));
  }
  expect_motion(scenes, thing, 6, 0);
}

/// Turned about the centre.
dvec2 turned(dvec2 p, dvec2 center, double angle) {
  const dvec2 d = p - center;
  return center +
         dvec2(std::cos(angle) * d.x - std::sin(angle) * d.y, std::sin(angle) * d.x + std::cos(angle) * d.y);
}

TEST(LayerOfMotion, OfAnObjectThatTurns) {
  const dvec2 center(6, 4);
  const double speed = glm::radians(25.0);
  constexpr double kHalf = 2.7;
  const Mover2d thing{[&](dvec2 p, double t) { return turned(p, center, t * speed); },
                      [&](dvec2 p, double t) {
                        const dvec2 q = turned(p, center, -t * speed), d = glm::abs(q - center);
                        return std::max(d.x, d.y) < kHalf ? q : dvec2(kNever);
                      }};
  SceneDescription scene = pixel_world(12, 8, kSpp);
  scene.shapes.push_back(rectangle({center - kHalf, 0}, 2 * kHalf, 2 * kHalf));
  {
    Mover move(scene);
    move.last_shape(move.node(keys_of([&](double t) {
      const dvec3 c(center, 0);
      return glm::translate(glm::rotate(glm::translate(glm::dmat4(1), c), t * speed, {0, 0, 1}), -c);
    })));
  }
  expect_motion({scene}, thing, 4, kMostDeviation);
}

TEST(LayerOfMotion, OfAMeshThatDeforms) {
  // Stretched along x from its left side on: x = left + (x0 - left) (1 + growth (t + 2)).
  const dvec2 low(3, 2);
  constexpr double kSize = 3, kGrowth = 0.2;
  const auto factor = [](double t) { return 1 + kGrowth * (t + 2); };
  const Mover2d thing{[&](dvec2 p, double t) { return dvec2(low.x + (p.x - low.x) * factor(t), p.y); },
                      [&](dvec2 p, double t) {
                        const dvec2 q(low.x + (p.x - low.x) / factor(t), p.y);
                        const dvec2 d = q - low;
                        return d.x > 0 && d.y > 0 && d.x < kSize && d.y < kSize ? q : dvec2(kNever);
                      }};
  SceneDescription scene = pixel_world(12, 8, kSpp);
  scene.shapes.push_back(rectangle({low, 0}, kSize, kSize));
  {
    Mover move(scene);
    move.deform(
        0, [&](const dvec3& p) { return dvec3(5 * kGrowth * (p.x - low.x), 0, 0); }, -2, 3);
  }
  expect_motion({scene}, thing, 2, 0);
}

TEST(LayerOfMotion, OfAnOrthographicCameraThatMoves) {
  const dvec2 speed(2.3, -1.1);
  SceneDescription scene = pixel_world(10, 6, kSpp);
  scene.shapes.push_back(rectangle({-100, -100, 3}, 200, 200));
  {
    Mover move(scene);
    move.camera(
        move.node(keys_of([&](double t) { return glm::translate(glm::dmat4(1), dvec3(t * speed, 0)); })));
  }
  expect_motion({scene}, translating(dvec2(-1e3), dvec2(1e3), -speed), 5, 0, Shape2d::kIsSmooth);
}

/// A pinhole camera at the origin that looks along z; x to the right, y down, as in pixel_world.
SceneDescription pinhole(dvec2 shift = dvec2(0)) {
  SceneDescription scene = pixel_world(12, 8, kSpp);
  scene.camera.projection = Projection::kPerspective;
  scene.camera.fov = 70;
  scene.camera.fov_axis = FovAxis::kX;
  scene.camera.principal_point_offset_x = shift.x;
  scene.camera.principal_point_offset_y = shift.y;
  scene.camera.to_world[3] = glm::dvec4(0, 0, 0, 1);
  return scene;
}
/// Where its film shows a point or a direction.
dvec2 pinhole_image(const dvec3& v, dvec2 shift) {
  const double per_unit = 6 / std::tan(glm::radians(35.0));
  return dvec2(6, 4) - shift * dvec2(12, 8) + per_unit * dvec2(v) / v.z;
}
dvec3 pinhole_direction(dvec2 film, dvec2 shift) {
  const double per_unit = 6 / std::tan(glm::radians(35.0));
  return dvec3((film - dvec2(6, 4) + shift * dvec2(12, 8)) / per_unit, 1);
}

class MovingPinhole : public testing::TestWithParam<dvec2> {};

TEST_P(MovingPinhole, MovesAndTurnsBeforeAWall) {
  const dvec2 shift = GetParam();
  constexpr double kWall = 9;
  const dvec3 speed(0.6, -0.3, 0.9);
  const double turn = glm::radians(6.0);
  const auto to_world = [&](double t) {
    return glm::rotate(glm::translate(glm::dmat4(1), t * speed), t * turn, {0, 1, 0});
  };
  const Mover2d thing{[&](dvec2 p, double t) {
                        return pinhole_image(dvec3(glm::inverse(to_world(t)) * glm::dvec4(p, kWall, 1)),
                                             shift);
                      },
                      [&](dvec2 p, double t) {
                        const dvec3 o(to_world(t)[3]);
                        const dvec3 d = glm::dmat3(to_world(t)) * pinhole_direction(p, shift);
                        return dvec2(o + d * (kWall - o.z) / d.z);
                      }};
  SceneDescription scene = pinhole(shift);
  scene.shapes.push_back(rectangle({-1e3, -1e3, kWall}, 2e3, 2e3));
  {
    Mover move(scene);
    move.camera(move.node(keys_of(to_world)));
  }
  expect_motion({scene}, thing, 6, kMostDeviation, Shape2d::kIsSmooth);
}

TEST_P(MovingPinhole, TurnsUnderTheSky) {
  const dvec2 shift = GetParam();
  const dvec3 axis = glm::normalize(dvec3(0.2, 1, 0.3));
  const double speed = glm::radians(7.0);
  const auto to_world = [&](double t) { return glm::rotate(glm::dmat4(1), t * speed, axis); };
  // Directions by their intersection with the plane z = 1 of the world, which is before all of them.
  const Mover2d thing{[&](dvec2 p, double t) {
                        return pinhole_image(glm::transpose(glm::dmat3(to_world(t))) * dvec3(p, 1), shift);
                      },
                      [&](dvec2 p, double t) {
                        const dvec3 d = glm::dmat3(to_world(t)) * pinhole_direction(p, shift);
                        return dvec2(d) / d.z;
                      }};
  SceneDescription scene = pinhole(shift);
  scene.emitters.push_back(ConstantEnvironment{});
  {
    Mover move(scene);
    move.camera(move.node(keys_of(to_world)));
  }
  expect_motion({scene}, thing, 6, kMostDeviation, Shape2d::kIsSmooth);
}

INSTANTIATE_TEST_SUITE_P(Shifts, MovingPinhole, testing::Values(dvec2(0), dvec2(0.2, -0.1)),
                         [](const auto& tested) { return tested.param.x == 0 ? "None" : "Lens"; });

}  // namespace
}  // namespace penumbra::motion_layers_test
