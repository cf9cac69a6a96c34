// The emitting side of lights: the dark side of a one-sided light, and what is in front of it, gets none of
// its light by any strategy, although rounding puts points of a light on either side of it.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::light_sides_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 32.0 / (1 << 24);  ///< relative; see furnace_test.cpp
/// The other triangles of a flat light are seen from its plane under angles of rounding, at both ends.
constexpr double kCoplanar = 1e-7;
constexpr int kPixels = 24;
constexpr float kAlbedo = 0.5f;

std::vector<IntegratorSettings> integrators() {
  std::vector<IntegratorSettings> all;
  for (const Strategy& strategy : all_strategies()) all.push_back(strategy.integrator);
  for (const EmitterSampling sampling : {EmitterSampling::kArea, EmitterSampling::kSolidAngle}) {
    IntegratorSettings mis = path_integrator(DirectSampling::kMis);
    param::emitter_sampling(mis) = sampling;
    all.push_back(mis);
    param::next_event(mis) = NextEvent::kCv;
    all.push_back(mis);
  }
  return all;
}

/// Around `center`, which is where the camera may stand; faces outwards, `turned` inwards.
struct LightShape {
  std::string name;
  std::function<std::vector<Shape>(const dvec3& center, bool turned)> make;
  bool closed;
};
void PrintTo(const LightShape& shape, std::ostream* out) { *out << shape.name; }

Shape round_light(const decltype(Shape::geometry)& geometry, bool turned) {
  Shape shape;
  shape.name = "light";
  shape.geometry = geometry;
  shape.radiance = glm::vec3(1);
  shape.flip_normals = turned;
  return shape;
}

/// Its six sides by themselves.
std::vector<Shape> cube(const dvec3& center, bool turned) {
  std::vector<Shape> sides;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      dvec3 n(0), u(0), v(0);
      n[axis] = 1.3 * sign;
      u[(axis + 1) % 3] = 2.6;
      v[(axis + 2) % 3] = 2.6;
      if (sign < 0) std::swap(u, v);
      sides.push_back(parallelogram(center + n - 0.5 * u - 0.5 * v, u, v, kBlackBsdf, 1.0f));
      sides.back().flip_normals = turned;
    }
  return sides;
}

std::vector<LightShape> light_shapes() {
  const dvec3 away = glm::normalize(dvec3(0.3, 0.2, 1));
  const dvec3 u = 3.0 * glm::normalize(glm::cross(dvec3(0, 1, 0), away)), v = glm::cross(away, u);
  return {
      {"Sphere",
       [](const dvec3& c, bool turned) {
         return std::vector{round_light(Sphere{c, 1.7}, turned)};
       },
       true},
      {"Cube", cube, true},
      {"Disk",
       [=](const dvec3& c, bool turned) {
         return std::vector{round_light(Disk{c + 1.1 * away, away, 2.5}, turned)};
       },
       false},
      {"Rectangle",
       [=](const dvec3& c, bool turned) {
         std::vector<Shape> shapes{parallelogram(c + 1.1 * away - 0.5 * u - 0.5 * v, u, v, kBlackBsdf, 1.0f)};
         shapes[0].flip_normals = turned;
         return shapes;
       },
       false},
      {"Triangle",
       [=](const dvec3& c, bool turned) {
         const dvec3 p = c + 1.1 * away - 0.6 * u - 0.5 * v;
         std::vector<Shape> shapes{triangles(std::array{p, p + 2.0 * u, p + 2.0 * v}, kBlackBsdf, 1.0f)};
         shapes[0].flip_normals = turned;
         return shapes;
       },
       false},
  };
}

/// A camera at the light's centre looks at it; both sides of the light reflect.
SceneDescription scene_of(const LightShape& light, const dvec3& center, bool turned, bool two_sided,
                          const IntegratorSettings& integrator, std::uint32_t spp) {
  SceneDescription scene = empty_scene(kPixels, kPixels, spp, 7);
  scene.camera = look_at(center, center + dvec3(0.1, 0.2, 1), dvec3(0, 1, 0), 70);
  const int grey = add_diffuse(scene, kAlbedo);
  for (Shape& shape : light.make(center, turned)) {
    shape.front_bsdf = shape.back_bsdf = grey;
    shape.two_sided_emission = two_sided;
    scene.shapes.push_back(shape);
  }
  scene.integrator = integrator;
  return scene;
}

constexpr std::array kCenters{dvec3(0.1, 0.2, 0.05), dvec3(31, -17, 5.3)};

class LightSides : public testing::TestWithParam<LightShape> {};

TEST_P(LightSides, TheDarkSideIsBlack) {
  for (const dvec3& center : kCenters)
    for (const IntegratorSettings& integrator : integrators()) {
      SceneDescription scene = scene_of(GetParam(), center, false, false, integrator, 16);
      // Something else to see the back of the light, and the light's own back beyond it.
      scene.shapes.push_back(
          parallelogram(center + dvec3(-0.3, -0.3, 0.8), dvec3(0.2, 0, 0.1), dvec3(0, 0.2, 0), 0));
      scene.shapes.back().back_bsdf = 0;
      const FilmAccumulator film = render_or_throw(scene);
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x)
          ASSERT_LE(film.at(x, y).mean[1], kCoplanar)
              << x << ", " << y << " by " << method_name(integrator.method);
    }
}

TEST_P(LightSides, AConvexLightDoesNotLightItsOwnFront) {
  for (const dvec3& center : kCenters)
    for (const IntegratorSettings& integrator : integrators()) {
      SceneDescription scene = scene_of(GetParam(), center, !GetParam().closed, false, integrator, 16);
      if (GetParam().closed) scene.camera = look_at(center - dvec3(0.5, 1, 7), center, dvec3(0, 1, 0), 20);
      const FilmAccumulator film = render_or_throw(scene);
      EXPECT_GT(film.at(kPixels / 2, kPixels / 2).mean[1], 0.9);
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) ASSERT_LE(film.at(x, y).mean[1], 1 + kRounding) << x << ", " << y;
    }
}

/// A closed room that shines inwards is a furnace; so is a two-sided one.
TEST_P(LightSides, TheBrightInsideIsAFurnace) {
  if (!GetParam().closed) return;
  for (const dvec3& center : kCenters)
    for (const bool two_sided : {false, true}) {
      if (two_sided && GetParam().name == "Sphere") continue;  // spheres shine to one side
      for (const Strategy& strategy : path_strategies()) {
        const SceneDescription scene =
            scene_of(GetParam(), center, !two_sided, two_sided, strategy.integrator, 64);
        const statistics::Sample sample = film_sample(render_or_throw(scene), 1);
        EXPECT_GT(statistics::t_test(sample, 2, 2 * kRounding).p,
                  statistics::sidak_significance(kSignificance, 3 * 2 * path_strategies().size()))
            << strategy.name << ": " << sample.mean() << " +- " << sample.standard_error();
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, LightSides, testing::ValuesIn(light_shapes()),
                         [](const auto& shape) { return shape.param.name; });

}  // namespace
}  // namespace penumbra::light_sides_test
