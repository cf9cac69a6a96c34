// Environment maps: radiance against Mitsuba 3, the pdf of directions against their frequencies and its own
// integral, single bright texels and black regions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/emitters.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::envmap_light_test {
namespace {

constexpr double kPi = std::numbers::pi;

SceneTables envmap_scene(int width, int height, const auto& texel, const glm::dmat3& to_world = glm::dmat3(1),
                         float scale = 1, bool balanced = false) {
  Bitmap image{"map", width, height, 3, TexelType::kFloat, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) image.words.push_back(FLOAT_BITS(glm::vec3(texel(x, y))[c]));
  EnvironmentMapLight map;
  map.image = std::make_shared<const Bitmap>(std::move(image));
  map.to_world = glm::dmat4(to_world);
  map.scale = scale;
  SceneTables tables;
  const auto local = [](const glm::dvec3& p) { return to_vec3(p); };
  Light light = map.light({local, 1.0, tables, nullptr, balanced}).light;
  light.pmf = 1;
  tables.lights.push_back(light);
  tables.header.environment = 0;
  return tables;
}

/// About an axis that is none of the image's.
const glm::dmat3 kTurned{{0.7827555537, 0.5487988591, -0.2934510708},
                         {-0.4819543958, 0.8328889012, 0.2720588744},
                         {0.3937177658, -0.0715255366, 0.9164444805}};
glm::vec3 numbered(int x, int y) {
  return {1.0f + float(x) + 10.0f * float(y), 2.0f + float((x * 3 + y) % 5), 0.5f * float(x * y)};
}

Emission found_along(const Scene& scene, const vec3& wi) {
  Surface s = receiver(make_vec3(0, 0, 0), negate(wi));
  s.primitive = -1;
  s.wo = negate(wi);
  return emission_at(scene, s);
}

LightSample sample(const Scene& scene, RandomNumbers& random) {
  const Surface point = surface_in_medium(make_vec3(0, 0, 0));
  const float u = random.unit_float(), v = random.unit_float();
  return sample_light(scene, point, u, v, random.unit_float());
}

TEST(EnvmapLight, RadianceIsMitsubas) {
  // Its envmap plugin (3.9, scalar_rgb): 5 x 4 texels, turned by 40 degrees about (1, 2, 3), scale 2.
  const struct {
    vec3 wi;
    glm::vec3 radiance;
  } kThere[] = {{{0.393717766f, -0.0715255365f, 0.91644448f}, {36, 9, 3}},
                {{0.782755554f, 0.548798859f, -0.293451071f}, {33.5f, 7.75f, 1.125f}},
                {{-0.822690308f, -0.181986138f, -0.538573802f}, {38.1159248f, 10.806653f, 5.62232876f}},
                {{0.896977425f, 0.0594974719f, -0.438054234f}, {43.4456978f, 5.19777012f, 1.40472722f}},
                {{-0.949884534f, -0.312444419f, 0.00989135168f}, {35.2177773f, 7.82045412f, 4.62090874f}},
                {{-0.165771812f, 0.778363705f, 0.605532527f}, {14.4905806f, 7.74860477f, 0.796381712f}},
                {{-0.819335938f, -0.570875585f, -0.0528175868f}, {40.854435f, 8.29576015f, 5.59812689f}},
                {{-0.810830474f, 0.410308361f, 0.417373866f}, {19.1362495f, 7.97782135f, 1.71765637f}},
                {{0.87454164f, -0.459198534f, -0.155928433f}, {53.4979553f, 5.60190248f, 2.74064851f}},
                {{0.910754979f, 0.288327873f, 0.295622021f}, {36.816597f, 7.68077517f, 2.05741787f}},
                {{-0.296347171f, -0.950187504f, 0.0965507552f}, {51.2473793f, 7.2438097f, 6.87298107f}},
                {{0.077373825f, -0.871125281f, -0.484926879f}, {61.1027336f, 7.52419567f, 10.1591606f}}};
  SceneTables tables = envmap_scene(5, 4, numbered, kTurned, 2);
  const Scene scene = tables.scene();
  for (const auto& [wi, radiance] : kThere) {
    const Emission e = found_along(scene, wi);
    // Angles are rounded to 1e-7 turns, over which radiance changes by 40 x 5 of them.
    EXPECT_NEAR(e.radiance.x, radiance.x, 1e-4);
    EXPECT_NEAR(e.radiance.y, radiance.y, 1e-4);
    EXPECT_NEAR(e.radiance.z, radiance.z, 1e-4);
  }
}

const std::vector<SceneTables>& kinds_of_maps() {
  static const std::vector<SceneTables> kMaps = {
      envmap_scene(5, 4, numbered, kTurned),
      envmap_scene(5, 4, numbered, kTurned, 2, true),
      envmap_scene(16, 9,
                   [](int x, int y) { return x == 11 && y == 3 ? glm::vec3(1e8f) : glm::vec3(1e-2f); }),
      envmap_scene(7, 5, [](int x, int y) { return x < 3 && y < 2 ? glm::vec3(1, 2, 3) : glm::vec3(0); }),
      envmap_scene(2, 2, [](int x, int y) { return glm::vec3(1.0f + float(x + y)); }),
      envmap_scene(64, 33, [](int, int y) { return glm::vec3(y == 0 ? 5.0f : 0.1f); })};
  return kMaps;
}

constexpr int kRows = 8, kColumns = 16;
/// Of (longitude about z, cos theta), equal areas.
int cell_of(const vec3& d) {
  const int row = std::min(int((double(d.z) + 1) / 2 * kRows), kRows - 1);
  const double turns = std::atan2(double(d.y), double(d.x)) / (2 * kPi);
  return row * kColumns + std::min(int((turns < 0 ? turns + 1 : turns) * kColumns), kColumns - 1);
}

TEST(EnvmapLight, SamplesFollowTheDensity) {
  constexpr int kSamples = 400'000, kFine = 80;
  const double significance = statistics::sidak_significance(0.01, kinds_of_maps().size());
  for (SceneTables tables : kinds_of_maps()) {
    const Scene scene = tables.scene();
    RandomNumbers random(3);
    std::vector<double> counts(kRows * kColumns), expected(kRows * kColumns);
    for (int k = 0; k < kSamples; ++k) {
      const LightSample s = sample(scene, random);
      ASSERT_GT(s.pdf, 0);
      ASSERT_NEAR(double(length(exact(s.wi))), 1, 1e-6);
      counts[std::size_t(cell_of(s.wi))] += 1;
    }
    // Of the density that other strategies are told, by midpoints.
    double total = 0;
    for (int i = 0; i < kRows * kFine; ++i)
      for (int j = 0; j < kColumns * kFine; ++j) {
        const double z = -1 + 2 * (i + 0.5) / (kRows * kFine), phi = 2 * kPi * (j + 0.5) / (kColumns * kFine);
        const double r = std::sqrt(1 - z * z);
        const vec3 d = make_vec3(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
        const double share = double(found_along(scene, d).pdf) * 4 * kPi / (kRows * kColumns * kFine * kFine);
        expected[std::size_t(cell_of(d))] += share * kSamples;
        total += share;
      }
    EXPECT_NEAR(total, 1, 5e-3);  // of midpoints on a spike of a sixteenth of a turn
    EXPECT_GT(statistics::chi_square_test(counts, expected).p, significance);
  }
}

/// Where a sample lies on the grid, from 0 to the width and to the height - 1.
glm::dvec2 on_grid(const vec3& wi, int width, int height) {
  const double turns = std::atan2(double(wi.x), -double(wi.z)) / (2 * kPi);
  const double angle = std::atan2(std::hypot(double(wi.x), double(wi.z)), double(wi.y)) / kPi;
  const double column = (turns < 0 ? turns + 1 : turns) * width - 0.5;
  return {column < 0 ? column + width : column, angle * (height - 1)};
}

/// Sums up to each place, in shares of the whole, of a density that is linear between `weights`.
double share_below(const std::vector<double>& weights, double place) {
  double sum = 0, below = 0;
  for (std::size_t k = 0; k + 1 < weights.size(); ++k) {
    const double a = weights[k], b = weights[k + 1], part = std::clamp(place - double(k), 0.0, 1.0);
    below += part * (a + 0.5 * part * (b - a));
    sum += 0.5 * (a + b);
  }
  return below / sum;
}

// As wide, and as high, as maps become, with one texel that outshines the others by 1e8: numbers of 24 bits
// still lead where the distributions have as much below them, to a few roundings.
TEST(EnvmapLight, DistributionsOfWideMapsWithASpikeAreInverted) {
  constexpr int kWidth = 16384, kHeight = 3, kSpike = 9000;
  SceneTables tables = envmap_scene(
      kWidth, kHeight, [](int x, int y) { return glm::vec3(x == kSpike && y == 1 ? 1e8f : 1.0f); });
  const Scene scene = tables.scene();
  const Surface point = surface_in_medium(make_vec3(0, 0, 0));
  int beyond = 0;
  for (const float v : {0.2f, 0.45f, 0.7f})
    for (int k = 0; k < 600; ++k) {
      // Near both ends of the range: between them it is the spike.
      const float u = k % 2 == 0 ? float(k) * 0x1p-24f * 7 : 1.0f - float(k) * 0x1p-24f * 3;
      const LightSample s = sample_light(scene, point, u, v, 0.0f);
      glm::dvec2 at = on_grid(s.wi, kWidth, kHeight);
      if (u < 0.5f && at.x > kWidth - 0.01) at.x = 0;  // rounded to the other side of the seam
      if (std::abs(at.x - kSpike) < 2) continue;
      const int row = int(at.y);
      std::vector<double> weights(kWidth + 1);
      for (int x = 0; x <= kWidth; ++x) {
        const auto weight = [&](int y) {
          return 3 * (x == kSpike && y == 1 ? 1e8 : 1.0) * double(envmap_row_sine(y, kHeight));
        };
        weights[std::size_t(x)] = glm::mix(weight(row), weight(row + 1), at.y - row);
      }
      ASSERT_NEAR(share_below(weights, at.x), double(u), 6 * 0x1p-24) << u << " at " << at.x << ", " << at.y;
      beyond += at.x > kSpike ? 1 : 0;
    }
  EXPECT_GT(beyond, 300);
}

TEST(EnvmapLight, DistributionsOfHighMapsWithASpikeAreInverted) {
  constexpr int kWidth = 2, kHeight = 8192, kSpike = 3000;
  SceneTables tables = envmap_scene(
      kWidth, kHeight, [](int x, int y) { return glm::vec3(x == 1 && y == kSpike ? 1e8f : 1.0f); });
  const Scene scene = tables.scene();
  const Surface point = surface_in_medium(make_vec3(0, 0, 0));
  std::vector<double> rows(kHeight);
  for (int y = 0; y < kHeight; ++y)
    rows[std::size_t(y)] = (y == kSpike ? 1e8 + 1 : 2) * double(envmap_row_sine(y, kHeight));
  int beyond = 0;
  for (int k = 0; k < 2000; ++k) {
    const float v = k % 2 == 0 ? float(k) * 0x1p-24f : 1.0f - float(k) * 0x1p-24f / 2;
    const LightSample s = sample_light(scene, point, 0.3f, v, 0.0f);
    const glm::dvec2 at = on_grid(s.wi, kWidth, kHeight);
    if (std::abs(at.y - kSpike) < 2) continue;
    ASSERT_NEAR(share_below(rows, at.y), double(v), 6 * 0x1p-24) << v << " at " << at.y;
    beyond += at.y > kSpike ? 1 : 0;
  }
  EXPECT_GT(beyond, 100);
}

TEST(EnvmapLight, ASampleSaysWhatARayFinds) {
  for (SceneTables tables : kinds_of_maps()) {
    const Scene scene = tables.scene();
    RandomNumbers random(4);
    for (int k = 0; k < 20'000; ++k) {
      const LightSample s = sample(scene, random);
      const Emission e = found_along(scene, s.wi);
      const float y = std::abs(s.wi.y);
      if (y > 0.9999f) continue;  // where longitude is rounded
      const double tolerance = 1e-3 * double(s.pdf) + 1e-4;
      ASSERT_NEAR(e.pdf, s.pdf, tolerance + 1e-3 * double(e.pdf));
      ASSERT_NEAR(e.radiance.x, s.radiance.x, 1e-3 * double(s.radiance.x) + 1e-3);
    }
  }
}

// Where light samples are weighted against BSDF samples, those of a dim sky with a sun are for the sun.
TEST(EnvmapLight, BalancedSamplesAreForWhatExceedsTheMean) {
  constexpr int kWidth = 16, kHeight = 9, kSamples = 100'000;
  const auto radiance = [](int x, int y) { return x % kWidth == 11 && y == 3 ? 50.0 : 1.0; };
  const auto sine = [](int y) { return double(envmap_row_sine(y, kHeight)); };
  double sum = 0, area = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      sum += sine(y) * radiance(x, y);
      area += sine(y);
    }
  for (const bool balanced : {false, true}) {
    const auto weight = [&](int x, int y) {
      const double above = radiance(x, y) - (balanced ? sum / area : 0);
      return std::max(above, double(ENVMAP_LEAST_SHARE) * radiance(x, y)) * sine(y);
    };
    double sky = 0,
           whole = 0;  // of the cells between texels; bilinear weights integrate to the corners' mean
    for (int y = 0; y + 1 < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double cell = weight(x, y) + weight(x + 1, y) + weight(x, y + 1) + weight(x + 1, y + 1);
        const bool of_sun = (x == 10 || x == 11) && (y == 2 || y == 3);
        sky += of_sun ? 0 : cell;
        whole += cell;
      }
    const auto grey = [&](int x, int y) { return glm::vec3(float(radiance(x, y))); };
    SceneTables tables = envmap_scene(kWidth, kHeight, grey, glm::dmat3(1), 1, balanced);
    const Scene scene = tables.scene();
    RandomNumbers random(6);
    int of_sky = 0;
    for (int k = 0; k < kSamples; ++k) of_sky += sample(scene, random).radiance.x <= 1.0f ? 1 : 0;
    const double share = sky / whole, error = std::sqrt(share * (1 - share) / kSamples);
    EXPECT_NEAR(double(of_sky) / kSamples, share, 5 * error) << balanced;
    EXPECT_NEAR(share, balanced ? 0.15 : 0.62, 0.01) << balanced;
  }
}

TEST(EnvmapLight, WeightsAreBounded) {
  // Radiance over density: what a diffuse receiver's sample carries. Bilinear in both, so between texels of
  // very different radiance too.
  for (SceneTables tables : kinds_of_maps()) {
    const Scene scene = tables.scene();
    RandomNumbers random(5);
    statistics::Sample weights;
    double largest = 0;
    for (int k = 0; k < 100'000; ++k) {
      const LightSample s = sample(scene, random);
      const double sum = double(s.radiance.x) + s.radiance.y + s.radiance.z;
      weights.add(sum / double(s.pdf));
      largest = std::max(largest, sum / double(s.pdf));
    }
    const double least_share = tables.envmaps[0].covered > 0 ? double(ENVMAP_LEAST_SHARE) : 1;
    EXPECT_LT(largest, 5 / least_share * weights.mean());
  }
}

}  // namespace
}  // namespace penumbra::envmap_light_test
