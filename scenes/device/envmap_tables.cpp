// The tables of an environment map; see kernels/light/envmap_light.h.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "kernels/light/envmap_grid.h"
#include "scenes/device/beam_lights.h"
#include "scenes/device/sum_levels.h"
#include "scenes/emitters.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/textures.h"

namespace penumbra {
namespace {

/// Appends the cumulative sums of the weights of a row's cells, for columns 0 to W. Returns the last sum.
double append_sums(std::span<const vec3> row, float sine, float covered, std::vector<float>& columns) {
  const auto weight = [&](const vec3& texel) { return double(envmap_weight(texel, sine, covered)); };
  const double first = weight(row.front());
  double sum = 0, here = first;
  const std::size_t start = columns.size();
  columns.push_back(0.0f);
  for (std::size_t x = 0; x < row.size(); ++x) {
    const double next = x + 1 < row.size() ? weight(row[x + 1]) : first;
    sum += 0.5 * (here + next);
    columns.push_back(float(sum));
    here = next;
  }
  append_sum_levels(start, columns);
  return sum;
}

/// The radiance of a texel; `least` is that of a channel.
vec3 radiance_of_texel(const BitmapValues& values, std::size_t channels, std::size_t index, float scale,
                       float least) {
  const auto channel = [&](std::size_t c) {
    const float value = values[channels * index + std::min(c, channels - 1)] * scale;
    return std::clamp(value, least, std::numeric_limits<float>::max());
  };
  return make_vec3(channel(0), channel(1), channel(2));
}

std::span<const vec3> texels_of_row(const std::vector<vec3>& texels, EnvironmentMap map, int y) {
  return std::span(texels).subspan(std::size_t(y) * std::size_t(map.width), std::size_t(map.width));
}

/// The mean radiance over the sphere.
glm::dvec3 mean_radiance(const std::vector<vec3>& texels, EnvironmentMap map) {
  glm::dvec3 sum(0.0);
  double area = 0;
  for (int y = 0; y < map.height; ++y) {
    const double sine = envmap_row_sine(y, map.height);
    for (const vec3& texel : texels_of_row(texels, map, y))
      sum += sine * glm::dvec3(texel.x, texel.y, texel.z);
    area += sine * map.width;
  }
  return sum / area;
}

}  // namespace

EmitterLight EnvironmentMapLight::light(const EmitterPlace& place) const {
  const int width = image->width, height = image->height;
  SceneRecords& records = place.records;
  records.envmap_texels.reserve(std::size_t(width) * std::size_t(height));
  const BitmapValues values(*image, kSrgb);
  const float least = has_wide_gamut ? std::numeric_limits<float>::lowest() : 0.0f;
  for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height); ++i)
    records.envmap_texels.push_back(radiance_of_texel(values, std::size_t(image->channels), i, scale, least));
  EnvironmentMap map{width, height, 0.0f};
  const glm::dvec3 mean = mean_radiance(records.envmap_texels, map);
  if (place.balanced) map.covered = float(mean.x + mean.y + mean.z);
  records.envmaps.push_back(map);
  records.envmap_columns.reserve(std::size_t(search_size(width + 1)) * std::size_t(height));
  records.envmap_rows.push_back(0.0f);
  std::vector<double> rows(std::size_t(height), 0.0);
  double last = 0;
  for (int y = 0; y < height; ++y) {
    const double sum = append_sums(texels_of_row(records.envmap_texels, map, y), envmap_row_sine(y, height),
                                   map.covered, records.envmap_columns);
    if (y > 0) rows[std::size_t(y)] = rows[std::size_t(y) - 1] + 0.5 * (last + sum);
    last = sum;
    records.envmap_rows.push_back(float(sum));
  }
  const double whole = rows.back();
  records.envmap_rows[0] = float(whole);
  records.envmap_rows.resize(std::size_t(envmap_shares(height)), 0.0f);
  for (const double row : rows) records.envmap_rows.push_back(whole > 0 ? float(row / whole) : 0.0f);
  append_sum_levels(std::size_t(envmap_shares(height)), records.envmap_rows);
  EmitterLight made = emitter_light(LIGHT_ENVMAP, glm::vec3(mean), sky_power(place));
  // The transform from world directions to those of the image.
  LightState state{};
  set_light_state(*this, place.local, state);
  made.light.p0 = state.p0;
  made.light.p1 = state.p1;
  made.light.p2 = state.p2;
  return made;
}

}  // namespace penumbra
