#include "scenes/device/medium_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <set>
#include <span>

#include "kernels/medium/majorant_grid.h"
#include "scenes/angles.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// Each block's least share of the samples is worth many steps of the random numbers.
constexpr std::size_t kMostBlocks = 1 << 15;
constexpr double kEvenShare = 0.05;
// Of a grid around several boxes, along each axis.
constexpr int kBoxCells = 16;
// What the largest number near a block adds to the mean of its own cells: interpolation reaches into blocks
// whose cells are 0.
constexpr double kNearShare = 0.1;
// What a place without density gets of the largest density's weight: the density may vary within a block.
constexpr double kLeastDensity = 0.02;

/// The numbers of a volume, averaged over channels.
class GridCells {
 public:
  GridCells(const Volume& v, std::span<const float> values) : v_(v), values_(values) {}

  [[nodiscard]] glm::ivec3 size() const { return {v_.nx, v_.ny, v_.nz}; }
  [[nodiscard]] double at(const glm::ivec3& cell) const {
    const std::size_t first =
        std::size_t(v_.first_value) +
        ((std::size_t(cell.z) * std::size_t(v_.ny) + std::size_t(cell.y)) * std::size_t(v_.nx) +
         std::size_t(cell.x)) *
            std::size_t(v_.channels);
    double sum = 0;
    for (int k = 0; k < v_.channels; ++k) sum += double(values_[first + std::size_t(k)]);
    return sum / v_.channels;
  }
  /// That of the cell at a point of the scene; 0 outside.
  [[nodiscard]] double around(const glm::dvec3& p) const {
    const glm::dvec3 from = p - to_dvec3(v_.corner);
    const glm::dvec3 place(glm::dot(to_dvec3(v_.row_x), from), glm::dot(to_dvec3(v_.row_y), from),
                           glm::dot(to_dvec3(v_.row_z), from));
    const glm::ivec3 cell = glm::ivec3(glm::floor(place));
    for (int axis = 0; axis < 3; ++axis)
      if (cell[axis] < 0 || cell[axis] >= size()[axis]) return 0;
    return at(cell);
  }
  [[nodiscard]] double largest() const {
    double most = 0;
    each({0, 0, 0}, size(), [&](const glm::ivec3& cell) { most = std::max(most, at(cell)); });
    return most;
  }

  template <typename Visit>
  static void each(const glm::ivec3& low, const glm::ivec3& high, const Visit& visit) {
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) visit(glm::ivec3(x, y, z));
  }

 private:
  const Volume& v_;
  std::span<const float> values_;
};

struct CellBlock {
  glm::ivec3 at;
  double weight;  ///< about the integral of the numbers over it, in cells; above 0
};

/// The blocks of that side, a power of two, in which the volume is above 0; more than kMostBlocks are not
/// looked for.
std::vector<CellBlock> blocks_of(const Volume& v, const GridCells& cells, std::span<const float> majorants,
                                 int side) {
  std::vector<CellBlock> blocks;
  const glm::ivec3 size = cells.size(), counts = (size + (side - 1)) / side;
  const int margin = v.nearest != 0 ? 0 : 1;
  GridCells::each({0, 0, 0}, counts, [&](const glm::ivec3& at) {
    const glm::ivec3 low = at * side, high = glm::min(low + side, size), coarse = low / MAJORANT_CELLS;
    const int majorant =
        v.first_majorant + (coarse.z * majorant_cells(v.ny) + coarse.y) * majorant_cells(v.nx) + coarse.x;
    const bool black = side <= MAJORANT_CELLS && !(majorants[std::size_t(majorant)] > 0);
    if (black || blocks.size() > kMostBlocks) return;
    double sum = 0, most = 0;
    GridCells::each(
        glm::max(low - margin, glm::ivec3(0)), glm::min(high + margin, size), [&](const glm::ivec3& cell) {
          const double value = cells.at(cell);
          const bool own = glm::all(glm::greaterThanEqual(cell, low)) && glm::all(glm::lessThan(cell, high));
          sum += own ? value : 0;
          most = std::max(most, value);
        });
    const glm::ivec3 extent = high - low;
    if (most > 0) blocks.push_back({at, sum + kNearShare * most * extent.x * extent.y * extent.z});
  });
  return blocks;
}

/// A grid around those boxes, in which the cells that meet one of them are 1. Returns its index, or -1 if the
/// boxes are flat.
int volume_around(std::span<const SceneBounds> boxes, SceneRecords& records) {
  SceneBounds all;
  for (const SceneBounds& box : boxes) all.include(box);
  // The coordinates round to single precision.
  const glm::dvec3 margin(1e-6 * glm::length(glm::max(glm::abs(all.low), glm::abs(all.high))));
  all.low -= margin;
  all.high += margin;
  const int side = boxes.size() == 1 ? 1 : kBoxCells;
  const glm::dvec3 cell = (all.high - all.low) / double(side);
  if (!(cell.x > 0 && cell.y > 0 && cell.z > 0)) return -1;
  Volume v{};
  v.corner = to_vec3(all.low);
  v.row_x = make_vec3(float(1 / cell.x), 0, 0);
  v.row_y = make_vec3(0, float(1 / cell.y), 0);
  v.row_z = make_vec3(0, 0, float(1 / cell.z));
  v.nx = v.ny = v.nz = side;
  v.channels = v.nearest = 1;
  v.first_value = int(records.volume_values.size());
  v.first_majorant = int(records.majorants.size());
  GridCells::each({0, 0, 0}, glm::ivec3(side), [&](const glm::ivec3& at) {
    const glm::dvec3 low = all.low + cell * glm::dvec3(at) - margin, high = low + cell + 2.0 * margin;
    const bool meets = std::ranges::any_of(boxes, [&](const SceneBounds& box) {
      return glm::all(glm::lessThanEqual(box.low, high)) && glm::all(glm::lessThanEqual(low, box.high));
    });
    records.volume_values.push_back(meets ? 1.0f : 0.0f);
  });
  const int coarse = majorant_cells(side);
  records.majorants.insert(records.majorants.end(),
                           std::size_t(coarse) * std::size_t(coarse) * std::size_t(coarse), 1.0f);
  records.volumes.push_back(v);
  return int(records.volumes.size()) - 1;
}

/// The medium's light by that volume; nothing if that is black.
std::optional<EmitterLight> light_of(int index, int volume, SceneRecords& records) {
  const Medium& medium = records.media[std::size_t(index)];
  const Volume& v = records.volumes[std::size_t(volume)];
  const GridCells cells(v, records.volume_values);
  std::vector<CellBlock> blocks;
  int side = 1;
  for (;; side *= 2) {
    blocks = blocks_of(v, cells, records.majorants, side);
    if (blocks.size() <= kMostBlocks) break;
  }
  const glm::dmat3 rows(to_dvec3(v.row_x), to_dvec3(v.row_y), to_dvec3(v.row_z));
  const glm::dmat3 axes = glm::inverse(glm::transpose(rows));
  const double cell_volume = std::abs(glm::determinant(axes));
  const bool by_density = medium.emission_grid >= 0 && medium.emission_by_density != 0;
  if (by_density) {
    const GridCells density(records.volumes[std::size_t(medium.density)], records.volume_values);
    const double least = kLeastDensity * density.largest();
    for (CellBlock& block : blocks) {
      const glm::dvec3 low = glm::dvec3(block.at * side),
                       high = glm::dvec3(glm::min(block.at * side + side, cells.size()));
      block.weight *= density.around(to_dvec3(v.corner) + axes * (0.5 * (low + high))) + least;
    }
  }

  // Moments of the emission over the volume, for the light's power and the size of what shines.
  double sum = 0, squares = 0;
  LightBounds bounds;
  bounds.infinite = false;
  bounds.low = glm::dvec3(1e300);
  bounds.high = glm::dvec3(-1e300);
  for (const CellBlock& block : blocks) {
    const glm::ivec3 low = block.at * side, high = glm::min(low + side, cells.size()), extent = high - low;
    sum += block.weight;
    squares += block.weight * block.weight / (double(extent.x) * extent.y * extent.z);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 place((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                             (corner & 4) != 0 ? high.z : low.z);
      const glm::dvec3 p = to_dvec3(v.corner) + axes * place;
      bounds.low = glm::min(bounds.low, p);
      bounds.high = glm::max(bounds.high, p);
    }
  }
  if (!(sum > 0) || !std::isfinite(sum * sum / squares)) return std::nullopt;

  const double section = std::pow(sum * sum / squares * cell_volume, 2.0 / 3);
  Glow glow{};
  glow.cell_x = to_vec3(axes[0]);
  glow.cell_y = to_vec3(axes[1]);
  glow.cell_z = to_vec3(axes[2]);
  glow.by_area = float(cell_volume / section);
  glow.medium = index;
  glow.volume = volume;
  glow.side = side;
  glow.first_block = int(records.glow_blocks.size());
  glow.blocks = int(blocks.size());
  double below = 0;
  for (const CellBlock& block : blocks) {
    records.glow_blocks.push_back(
        {block.at.x, block.at.y, block.at.z,
         float(std::round(below * double(LIGHT_PROBABILITY_STEPS)) / double(LIGHT_PROBABILITY_STEPS))});
    below += (1 - kEvenShare) * block.weight / sum + kEvenShare / double(blocks.size());
  }
  const vec3 e = medium.emission;
  const double intensity = (double(e.x) + double(e.y) + double(e.z)) / 3 * sum * cell_volume;
  EmitterLight made = emitter_light(LIGHT_MEDIUM, glm::vec3(0.0f), 1);
  made.light.area = float(section);
  made.light.radiance = to_vec3(to_dvec3(e) * (sum * cell_volume / section));
  made.light.p0 = to_vec3(0.5 * (bounds.low + bounds.high));
  made.light.beam = int(records.glows.size());
  made.power = 4 * kPi * intensity;
  bounds.reach = kPi;
  bounds.intensity = intensity;
  made.bounds = bounds;
  records.glows.push_back(glow);
  return made;
}

}  // namespace

std::vector<MediumLight> medium_lights(int camera_medium, const MediumBoxes& boxes, SceneRecords& records) {
  std::set<int> present{camera_medium};
  for (const Boundary& boundary : records.boundaries) {
    present.insert(boundary.interior);
    present.insert(boundary.exterior);
  }
  std::vector<MediumLight> lights;
  for (const int index : present) {
    if (index <= 0) continue;
    const Medium& medium = records.media[std::size_t(index)];
    if (!(max_component(medium.emission) > 0)) continue;
    int volume =
        medium.emission_grid >= 0 || medium.emission_by_density == 0 ? medium.emission_grid : medium.density;
    // A camera within may be where no box is.
    if (volume < 0 && boxes.contains(index) && index != camera_medium)
      volume = volume_around(boxes.at(index), records);
    if (volume < 0) continue;
    if (std::optional<EmitterLight> light = light_of(index, volume, records))
      lights.push_back({index, *light});
  }
  return lights;
}

}  // namespace penumbra
