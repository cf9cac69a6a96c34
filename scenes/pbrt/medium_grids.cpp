#include "scenes/pbrt/medium_grids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "scenes/spectrum.h"

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

constexpr double kColdest = 100.0;  ///< K; colder media do not emit

/// The colours of black bodies between two temperatures, interpolated between those of a table: errors are
/// below 1e-4 of the largest channel above 500 K, where any light is seen.
class BlackBodies {
 public:
  BlackBodies(double low, double high, const std::function<glm::vec3(const glm::vec3&)>& film_colour)
      : low_(low) {
    for (double kelvin = low;; kelvin *= kRatio) {
      colours_.push_back(film_colour(unit_blackbody_to_rgb(kelvin)));
      if (kelvin >= high) break;
    }
  }
  /// Between two of the table, powers of the temperature, which they resemble.
  [[nodiscard]] glm::vec3 at(double kelvin) const {
    const double place = std::log(kelvin / low_) / std::log(kRatio);
    const auto last = double(colours_.size() - 1);
    const auto row = std::size_t(std::clamp(std::floor(place), 0.0, std::max(last - 1, 0.0)));
    const glm::vec3 &a = colours_[row], &b = colours_[std::min(row + 1, colours_.size() - 1)];
    const auto share = float(place - double(row));
    glm::vec3 colour;
    for (int c = 0; c < 3; ++c)
      colour[c] =
          a[c] > 0.0f && b[c] > 0.0f ? a[c] * std::pow(b[c] / a[c], share) : std::lerp(a[c], b[c], share);
    return glm::max(colour, 0.0f);
  }

 private:
  static constexpr double kRatio = 1.001;
  double low_;
  std::vector<glm::vec3> colours_;
};

/// The value of a grid at a place in its box, [0, 1]^3, interpolated towards cells of value 0 around it.
double value_in_box(const VolumeGrid& grid, const glm::dvec3& place) {
  const glm::dvec3 at = place * glm::dvec3(grid.nx, grid.ny, grid.nz) - 0.5, low = glm::floor(at);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2), cell = glm::ivec3(low) + step;
    const bool inside =
        cell.x >= 0 && cell.x < grid.nx && cell.y >= 0 && cell.y < grid.ny && cell.z >= 0 && cell.z < grid.nz;
    const glm::dvec3 share = glm::mix(1.0 - (at - low), at - low, glm::dvec3(step));
    const std::size_t index =
        (std::size_t(cell.z) * std::size_t(grid.ny) + std::size_t(cell.y)) * std::size_t(grid.nx) +
        std::size_t(cell.x);
    if (inside) sum += share.x * share.y * share.z * double(grid.values[index]);
  }
  return sum;
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

int refinement_of(const VolumeGrid& size) {
  constexpr std::size_t kFewCells = std::size_t{1} << 21;
  const std::size_t cells = std::size_t(size.nx) * std::size_t(size.ny) * std::size_t(size.nz);
  int finer = 4;
  while (finer > 1 && cells * std::size_t(finer * finer * finer) > kFewCells) finer /= 2;
  return finer;
}

std::vector<float> refined(const std::vector<float>& values, const VolumeGrid& size, int channels,
                           int finer) {
  /// The cell below a fine cell's centre, and the share of the one above.
  struct Between {
    int low;
    double share;
  };
  const auto between = [&](int fine) {
    const double at = (fine + 0.5) / finer - 0.5;
    return Between{int(std::floor(at)), at - std::floor(at)};
  };
  const auto cell = [&](int x, int y, int z, int c) {
    const bool inside = x >= 0 && x < size.nx && y >= 0 && y < size.ny && z >= 0 && z < size.nz;
    if (!inside) return 0.0;
    const std::size_t index =
        (std::size_t(z) * std::size_t(size.ny) + std::size_t(y)) * std::size_t(size.nx) + std::size_t(x);
    return double(values[index * std::size_t(channels) + std::size_t(c)]);
  };
  std::vector<float> result;
  for (int z = 0; z < finer * size.nz; ++z)
    for (int y = 0; y < finer * size.ny; ++y)
      for (int x = 0; x < finer * size.nx; ++x) {
        const Between bx = between(x), by = between(y), bz = between(z);
        for (int c = 0; c < channels; ++c) {
          double sum = 0;
          for (int corner = 0; corner < 8; ++corner) {
            const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
            const double weight = (i != 0 ? bx.share : 1 - bx.share) * (j != 0 ? by.share : 1 - by.share) *
                                  (k != 0 ? bz.share : 1 - bz.share);
            if (weight > 0.0) sum += weight * cell(bx.low + i, by.low + j, bz.low + k, c);
          }
          result.push_back(float(sum));
        }
      }
  return result;
}

VolumeGrid black_body_grid(const VolumeGrid& temperatures, const TemperatureScale& kelvins,
                           const std::optional<VolumeGrid>& strengths, const glm::vec3& factor,
                           const std::function<glm::vec3(const glm::vec3&)>& film_colour) {
  const int finer = refinement_of(temperatures);
  VolumeGrid result{finer * temperatures.nx, finer * temperatures.ny, finer * temperatures.nz, 3, {}};
  std::vector<float> hot = refined(temperatures.values, temperatures, 1, finer);
  double low = HUGE_VAL, high = 0;
  for (float& number : hot) {
    const double kelvin = (double(number) - kelvins.offset) * kelvins.scale;
    number = float(kelvin);
    if (!(kelvin > kColdest) || !std::isfinite(kelvin)) continue;
    low = std::min(low, double(number));
    high = std::max(high, double(number));
  }
  result.values.assign(3 * hot.size(), 0.0f);
  if (!(low <= high)) return result;
  const BlackBodies colours(low, high, film_colour);
  const glm::dvec3 cells(result.nx, result.ny, result.nz);
  std::size_t i = 0;
  for (int z = 0; z < result.nz; ++z)
    for (int y = 0; y < result.ny; ++y)
      for (int x = 0; x < result.nx; ++x, ++i) {
        if (!(double(hot[i]) >= low)) continue;
        const double strength =
            strengths ? value_in_box(*strengths, (glm::dvec3(x, y, z) + 0.5) / cells) : 1.0;
        const glm::vec3 colour = factor * float(strength) * colours.at(double(hot[i]));
        for (std::size_t c = 0; c < 3; ++c) result.values[3 * i + c] = colour[int(c)];
      }
  return result;
}

}  // namespace penumbra::pbrt
