// Textured lights: points are distributed by the pdf of their grids, which can be evaluated at hits, too;
// samples and rays bring the texture's value at the point.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scenes/device/to_vec3.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::light_grid_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kWidth = 13, kHeight = 7;

/// Texels of which few are bright.
float texel(int x, int y) { return (x * 5 + y * 3) % 11 == 4 ? float(3 + x) : 0.05f * float(1 + y); }

/// One light whose radiance is an image, without filter.
SceneDescription lit_by_image(decltype(Shape::geometry) geometry, BitmapFilter filter, bool inwards = false) {
  SceneDescription scene;
  scene.source = "a test";
  Bitmap image{"image", kWidth, kHeight, 1, TexelType::kFloat, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) image.words.push_back(FLOAT_BITS(texel(x, y)));
  scene.bitmaps.push_back(std::make_shared<const Bitmap>(std::move(image)));
  BitmapTexture texture;
  texture.bitmap = 0;
  texture.filter = filter;
  texture.wrap_u = texture.wrap_v = WRAP_CLAMP;
  scene.textures.push_back({"image", texture});
  Shape shape;
  shape.name = "light";
  shape.geometry = std::move(geometry);
  shape.radiance = glm::vec3(1, 2, 4);
  shape.radiance_texture = 0;
  shape.flip_normals = inwards;
  scene.shapes.push_back(shape);
  return scene;
}

struct TexturedCase {
  std::string name;
  decltype(Shape::geometry) geometry;
  double widest = 0.55;  ///< 1 - cosine from the z axis: the light is within
  bool inwards = false;
};
void PrintTo(const TexturedCase& tested, std::ostream* out) { *out << tested.name; }

std::vector<TexturedCase> cases() {
  Mesh triangle;
  triangle.positions = {{-1, -1, 2}, {0.2, 1.5, 3}, {2, -1, 2.5}};
  triangle.texcoords = {{0.1f, 0.05f}, {0.3f, 0.95f}, {0.9f, 0.2f}};
  triangle.triangles = {{0, 1, 2}};
  Mesh rectangle;
  rectangle.positions = {{-1, -1, 2}, {-1, 1, 2}, {1.5, 1, 2.5}, {1.5, -1, 2.5}};
  rectangle.texcoords = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  rectangle.triangles = {{0, 1, 2}, {0, 2, 3}};
  const glm::dvec3 z = glm::normalize(glm::dvec3(0.2, 0.1, -1));
  const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), z)), y = glm::cross(z, x);
  return {{"Triangle", triangle},
          {"Rectangle", rectangle},
          {"Disk", Disk{{0.3, -0.2, 2}, z, 1.3, x, y}},
          {"Sphere", Sphere{{0.4, 0.3, 3}, 1.2, x, y, z}},
          {"SphereFromInside", Sphere{{0.4, 0.3, 0.5}, 1.2, x, y, z}, 2.0, true}};
}

class TexturedLights : public testing::TestWithParam<TexturedCase> {
 protected:
  static SceneDescription described(BitmapFilter filter) {
    return lit_by_image(GetParam().geometry, filter, GetParam().inwards);
  }
  static DeviceScene device(BitmapFilter filter) { return build_device_scene(described(filter), {}).value(); }
};
INSTANTIATE_TEST_SUITE_P(All, TexturedLights, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

/// The origin: the builder moves scenes.
vec3 viewpoint(const SceneDescription& description) { return to_vec3(-scene_center(description)); }

LightSample sample(const Scene& scene, const vec3& from, RandomNumbers& random) {
  const float u = random.unit_float(), v = random.unit_float();
  return sample_light(scene, surface_in_medium(from), u, v, random.unit_float());
}

Surface meets(const Scene& scene, const vec3& origin, const vec3& wi) {
  const int count = scene.header.tables.triangles.count + scene.header.tables.quadrics.count;
  Surface nearest = surface_at(&scene, -1, origin, wi);
  float distance = 1e30f;
  for (int k = 0; k < count; ++k) {
    const Surface s = surface_at(&scene, k, origin, wi);
    bool inside = s.distance > 0 && s.distance < distance;
    if (inside && k < scene.header.tables.triangles.count) {
      const Barycentric b = barycentric_of(scene.triangles + k, s.p);
      inside = b.b0 >= 0 && b.b1 >= 0 && b.b2 >= 0;
    }
    if (!inside || !s.front) continue;
    nearest = s;
    distance = s.distance;
  }
  return nearest;
}

TEST_P(TexturedLights, HaveAGrid) {
  const DeviceScene device_scene = device(BitmapFilter::kNearest);
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  for (int k = 0; k < scene.header.tables.lights.count; ++k) {
    EXPECT_GE(scene.lights[k].texture, 0);
    EXPECT_GE(scene.lights[k].grid, 0);
    EXPECT_EQ(scene.lights[k].sampling, EMITTER_AREA);
  }
}

TEST_P(TexturedLights, ASampleSaysWhatARayFinds) {
  const SceneDescription description = described(BitmapFilter::kBilinear);
  const DeviceScene device_scene = device(BitmapFilter::kBilinear);
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  const vec3 from = viewpoint(description);
  RandomNumbers random(1);
  int compared = 0, density_differs = 0;
  for (int k = 0; k < 4000; ++k) {
    const LightSample s = sample(scene, from, random);
    if (!(s.tmax > 0)) continue;
    const Surface found = meets(scene, from, s.wi);
    if (found.primitive < 0 || dot3(found.geometric, found.wo) < 0.1f) continue;
    const Emission e = emission_at(scene, found);
    // Bilinear: over a rounding of the position the value changes by that of its slope.
    ASSERT_NEAR(e.radiance.z, s.radiance.z, 1e-3 * (1 + double(s.radiance.z)));
    ASSERT_NEAR(s.radiance.z, 4 * double(s.radiance.x), 1e-5 * double(s.radiance.z));
    // At the edges of cells rounding decides.
    density_differs += std::abs(e.pdf / s.pdf - 1) > 1e-3f ? 1 : 0;
    ++compared;
  }
  EXPECT_GT(compared, 1000);
  EXPECT_LE(density_differs, compared / 200);
}

class TexturedLightsWithoutARim : public TexturedLights {};
INSTANTIATE_TEST_SUITE_P(All, TexturedLightsWithoutARim, testing::ValuesIn([] {
                           std::vector<TexturedCase> some = cases();
                           std::erase_if(some, [](const TexturedCase& c) { return c.name == "Sphere"; });
                           return some;
                         }()),
                         [](const auto& tested) { return tested.param.name; });

/// Of directions, in cells of equal solid angle about the z axis: counts of samples against integrals of the
/// density that rays are told. Of a sphere from inside: at the rim it would grow without bound.
TEST_P(TexturedLightsWithoutARim, SamplesFollowTheDensityThatRaysAreTold) {
  constexpr int kRows = 12, kColumns = 24, kFine = 64, kSamples = 200'000;
  const double widest = GetParam().widest;
  const SceneDescription description = described(BitmapFilter::kNearest);
  const DeviceScene device_scene = device(BitmapFilter::kNearest);
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  const vec3 from = viewpoint(description);
  std::vector<double> counts(kRows * kColumns + 1), expected(counts.size());
  const auto cell = [&](const vec3& d) {
    const int row = int((1 - double(d.z)) / widest * kRows);
    const double turns = std::atan2(double(d.y), double(d.x)) / (2 * kPi) + 0.5;
    return row >= kRows ? kRows * kColumns : row * kColumns + std::min(int(turns * kColumns), kColumns - 1);
  };
  RandomNumbers random(2);
  int unseen = 0;  // on the far side of a sphere
  for (int k = 0; k < kSamples; ++k) {
    const LightSample s = sample(scene, from, random);
    if (s.tmax > 0)
      counts[std::size_t(cell(s.wi))] += 1;
    else
      ++unseen;
  }
  double total = 0;
  for (int i = 0; i < kRows * kFine; ++i)
    for (int k = 0; k < kColumns * kFine; ++k) {
      const double z = 1 - widest * (i + 0.5) / (kRows * kFine);
      const double phi = 2 * kPi * ((k + 0.5) / (kColumns * kFine) - 0.5), r = std::sqrt(1 - z * z);
      const vec3 d = make_vec3(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
      const Surface found = meets(scene, from, d);
      if (found.primitive < 0) continue;
      const double share = double(emission_at(scene, found).pdf) * 2 * kPi * widest /
                           (double(kRows * kFine) * kColumns * kFine);
      expected[std::size_t(cell(d))] += share * kSamples;
      total += share;
    }
  const double seen = 1 - double(unseen) / kSamples;
  // Midpoints miss a part of the cells' edges.
  EXPECT_NEAR(total / seen, 1, 0.01);
  for (double& value : expected) value *= seen / total;
  EXPECT_GT(statistics::chi_square_test(counts, expected).p, 0.01 / 4);
}

/// Radiance over density is what a diffuse receiver's sample carries, but for geometry: by the grid it varies
/// by less than by uniform points.
TEST_P(TexturedLights, SamplesCarryMoreAlikeThanUniformOnes) {
  SceneDescription description = described(BitmapFilter::kNearest);
  double variance[2];
  for (const bool uniform : {false, true}) {
    description.shapes[0].sampling = uniform ? EmitterSampling::kArea : EmitterSampling::kAuto;
    const DeviceScene device_scene = build_device_scene(description, {}).value();
    const Scene scene = make_scene(device_scene.header, device_scene.words.data());
    const vec3 from = viewpoint(description);
    RandomNumbers random(3);
    statistics::Sample carried;
    for (int k = 0; k < 100'000; ++k) {
      const LightSample s = sample(scene, from, random);
      carried.add(s.tmax > 0 ? double(s.radiance.x) / double(s.pdf) : 0);
    }
    variance[uniform ? 1 : 0] = carried.variance() / (carried.mean() * carried.mean());
    EXPECT_EQ(scene.lights[0].grid >= 0, !uniform);
  }
  EXPECT_LT(variance[0], 0.6 * variance[1]) << variance[0] << " " << variance[1];
}

TEST(LightGrid, ProbabilitiesOfCellsAddUp) {
  const DeviceScene device_scene =
      build_device_scene(lit_by_image(cases()[2].geometry, BitmapFilter::kNearest), {}).value();
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  const Light& light = scene.lights[0];
  const int side = light.grid_side;
  ASSERT_EQ(side, 16);
  double sum = 0;
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k) {
      const float u = (float(i) + 0.5f) / float(side), v = (float(k) + 0.5f) / float(side);
      sum += double(light_grid_density(&scene, &light, u, v)) / (side * side);
    }
  EXPECT_NEAR(sum, 1, 1e-5);
  // The ends of the range.
  for (const float u : {0.0f, ONE_MINUS_EPSILON})
    for (const float v : {0.0f, ONE_MINUS_EPSILON}) {
      const GridPoint p = sample_light_grid(&scene, &light, u, v);
      EXPECT_TRUE(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1 && p.density > 0);
      EXPECT_EQ(p.density, light_grid_density(&scene, &light, p.u, p.v));
    }
}

TEST(LightGrid, EvenTexturesHaveNone) {
  SceneDescription description = lit_by_image(cases()[1].geometry, BitmapFilter::kNearest);
  CheckerboardTexture board;  // 0.4 and 0.2
  description.textures[0].model = board;
  const DeviceScene device_scene = build_device_scene(description, {}).value();
  const Scene scene = make_scene(device_scene.header, device_scene.words.data());
  EXPECT_EQ(scene.lights[0].grid, -1);
  EXPECT_EQ(scene.header.tables.light_grids.count, 0);
}

}  // namespace
}  // namespace penumbra::light_grid_test
