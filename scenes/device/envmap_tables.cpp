// The tables of an environment map, see kernels/light/envmap_light.h.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/light/envmap_grid.h"
#include "scenes/emitters.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/textures/bitmap.h"

namespace penumbra {
namespace {

/// The sum of the weights of a row's cells, from its first column up to each, of columns 0 to W.
std::vector<double> sums_of_row(const std::vector<vec3>& texels, int width, int height, int y) {
  const float sine = envmap_row_sine(y, height);
  const auto weight = [&](int x) {
    return double(envmap_weight(texels[std::size_t(y) * std::size_t(width) + std::size_t(x % width)], sine));
  };
  std::vector<double> sums(std::size_t(width) + 1, 0.0);
  for (int x = 0; x < width; ++x)
    sums[std::size_t(x) + 1] = sums[std::size_t(x)] + 0.5 * (weight(x) + weight(x + 1));
  return sums;
}

/// What is below 0, as resampled images have it beside bright texels, shines not.
vec3 radiance_of_texel(const Bitmap& image, std::size_t index, float scale) {
  const std::size_t n = std::size_t(image.channels);
  const auto channel = [&](std::size_t c) {
    const double most = double(std::numeric_limits<float>::max());
    return float(
        std::clamp(bitmap_value(image, n * index + std::min(c, n - 1), kSrgb) * double(scale), 0.0, most));
  };
  return make_vec3(channel(0), channel(1), channel(2));
}

}  // namespace

EmitterLight EnvironmentMapLight::light(const EmitterPlace& place) const {
  const int width = image->width, height = image->height;
  SceneRecords& records = place.records;
  records.envmaps.push_back({width, height});
  records.envmap_texels.reserve(std::size_t(width) * std::size_t(height));
  for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height); ++i)
    records.envmap_texels.push_back(radiance_of_texel(*image, i, scale));
  std::vector<double> rows(std::size_t(height), 0.0);
  double last = 0;
  glm::dvec3 mean(0.0);
  double area = 0;
  for (int y = 0; y < height; ++y) {
    const std::vector<double> sums = sums_of_row(records.envmap_texels, width, height, y);
    for (const double sum : sums) records.envmap_columns.push_back(float(sum));
    if (y > 0) rows[std::size_t(y)] = rows[std::size_t(y) - 1] + 0.5 * (last + sums.back());
    last = sums.back();
    const double sine = envmap_row_sine(y, height);
    area += sine * width;
    for (int x = 0; x < width; ++x) {
      const vec3& texel = records.envmap_texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
      mean += sine * glm::dvec3(texel.x, texel.y, texel.z);
    }
  }
  const double whole = rows.back();
  for (const double row : rows) records.envmap_rows.push_back(whole > 0 ? float(row / whole) : 0.0f);
  records.envmap_rows.push_back(float(whole));
  EmitterLight made = emitter_light(LIGHT_ENVMAP, glm::vec3(mean / area), sky_power(place));
  // From directions of the world to those of the image.
  made.light.p0 = to_vec3(glm::normalize(glm::dvec3(to_world[0])));
  made.light.p1 = to_vec3(glm::normalize(glm::dvec3(to_world[1])));
  made.light.p2 = to_vec3(glm::normalize(glm::dvec3(to_world[2])));
  return made;
}

}  // namespace penumbra
