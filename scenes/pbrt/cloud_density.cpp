#include "scenes/pbrt/cloud_density.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace penumbra::pbrt {
namespace {

constexpr int kMostCloudCells = 128;
constexpr double kLacunarity = 1.99;  ///< not 2, so that the lattices of octaves do not coincide

/// A hash of a lattice corner.
std::uint32_t hashed(const glm::ivec3& corner) {
  std::uint32_t h = std::uint32_t(corner.x) * 0x8da6b343u ^ std::uint32_t(corner.y) * 0xd8163841u ^
                    std::uint32_t(corner.z) * 0xcb1ab31fu;
  h = (h ^ h >> 16) * 0x7feb352du;
  h = (h ^ h >> 15) * 0x846ca68bu;
  return h ^ h >> 16;
}

/// The gradient at a corner, one of the twelve directions to the edges of a cube, times the offset (Perlin,
/// Improving Noise, 2002).
double slope(const glm::ivec3& corner, const glm::dvec3& d) {
  const std::uint32_t h = hashed(corner) % 12;
  const double a = h < 8 ? d.x : d.y, b = h < 4 ? d.y : d.z;
  return ((h & 1) != 0 ? -a : a) + ((h & 2) != 0 ? -b : b);
}

double gradient_noise(const glm::dvec3& p) {
  const glm::dvec3 cell = glm::floor(p), d = p - cell;
  const glm::dvec3 w = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
  const glm::ivec3 base(cell);
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 step(k & 1, k >> 1 & 1, k >> 2);
    const glm::dvec3 share = glm::mix(1.0 - w, w, glm::dvec3(step));
    sum += share.x * share.y * share.z * slope(base + step, d - glm::dvec3(step));
  }
  return sum;
}

glm::dvec3 noise_slope(const glm::dvec3& p) {
  constexpr double kStep = 0.01;
  const double here = gradient_noise(p);
  return glm::dvec3(gradient_noise(p + glm::dvec3(kStep, 0, 0)), gradient_noise(p + glm::dvec3(0, kStep, 0)),
                    gradient_noise(p + glm::dvec3(0, 0, kStep))) /
             kStep -
         here / kStep;
}

}  // namespace

double Cloud::at(const glm::dvec3& place) const {
  glm::dvec3 p = frequency * place;
  double strength = 0.05 * wispiness, scale = 10.0;
  for (int octave = 0; octave < 2 && strength > 0; ++octave) {
    p += strength * noise_slope(scale * p);
    strength *= 0.5;
    scale *= kLacunarity;
  }
  double sum = 0;
  strength = 0.5;
  scale = 1.0;
  for (int octave = 0; octave < 5; ++octave) {
    sum += strength * gradient_noise(scale * p);
    strength *= 0.5;
    scale *= kLacunarity;
  }
  const double high = std::clamp((1 - place.y) * 4.5 * density * sum, 0.0, 1.0);
  return std::clamp(high + 2 * std::max(0.0, 0.5 - place.y), 0.0, 1.0);
}

VolumeGrid cloud_grid(const Cloud& cloud, const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  const glm::ivec3 cells =
      glm::clamp(glm::ivec3(glm::ceil(double(kMostCloudCells) * size / longest)), 1, kMostCloudCells);
  VolumeGrid grid{cells.x, cells.y, cells.z, 1, {}};
  grid.values.reserve(std::size_t(cells.x) * std::size_t(cells.y) * std::size_t(cells.z));
  for (int z = 0; z < cells.z; ++z)
    for (int y = 0; y < cells.y; ++y)
      for (int x = 0; x < cells.x; ++x)
        grid.values.push_back(float(cloud.at(low + size * (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(cells))));
  return grid;
}

}  // namespace penumbra::pbrt
