#include "scenes/device/volume_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "kernels/medium/majorant_grid.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

constexpr std::int64_t kMostNumbers = std::numeric_limits<int>::max() / 2;

/// The fine cells that affect a cell of the coarse grid, including the neighbours that interpolation reads.
struct Range {
  int from, to;
};
Range cells_of(int coarse, int cells, bool nearest) {
  const int margin = nearest ? 0 : 1, first = coarse * MAJORANT_CELLS;
  return {std::max(first - margin, 0), std::min(first + MAJORANT_CELLS + margin, cells)};
}

float largest(const VolumeGrid& grid, Range x, Range y, Range z) {
  float most = 0.0f;
  for (int k = z.from; k < z.to; ++k)
    for (int j = y.from; j < y.to; ++j) {
      const std::size_t row = (std::size_t(k) * std::size_t(grid.ny) + std::size_t(j)) * std::size_t(grid.nx);
      const auto channels = std::size_t(grid.channels);
      const auto* begin = grid.values.data() + (row + std::size_t(x.from)) * channels;
      most = std::max(most, *std::max_element(begin, begin + std::size_t(x.to - x.from) * channels));
    }
  return most;
}

void append_majorants(const VolumeGrid& grid, bool nearest, std::vector<float>& majorants) {
  for (int z = 0; z < majorant_cells(grid.nz); ++z)
    for (int y = 0; y < majorant_cells(grid.ny); ++y)
      for (int x = 0; x < majorant_cells(grid.nx); ++x)
        majorants.push_back(largest(grid, cells_of(x, grid.nx, nearest), cells_of(y, grid.ny, nearest),
                                    cells_of(z, grid.nz, nearest)));
}

}  // namespace

Expected<int> VolumeTables::add(const GridVolume& volume, SceneRecords& records) {
  const VolumeGrid& grid = *volume.grid;
  if (std::max({grid.nx, grid.ny, grid.nz}) > MAX_VOLUME_CELLS)
    return fail(fmt::format("a volume of {} x {} x {} cells; there may be {} along an axis", grid.nx, grid.ny,
                            grid.nz, MAX_VOLUME_CELLS));
  if (std::int64_t(records.volume_values.size() + grid.values.size()) > kMostNumbers)
    return fail(fmt::format("the volumes of the scene have more than {} numbers", kMostNumbers));
  const auto [entry, is_new] = known_.try_emplace({&grid, volume.nearest});
  if (is_new) {
    // A grid has different majorants with and without interpolation.
    const auto other = known_.find({&grid, !volume.nearest});
    const bool stored = other != known_.end();
    entry->second = {stored ? other->second.first_value : int(records.volume_values.size()),
                     int(records.majorants.size())};
    if (!stored)
      records.volume_values.insert(records.volume_values.end(), grid.values.begin(), grid.values.end());
    append_majorants(grid, volume.nearest, records.majorants);
  }

  const glm::dvec3 cells(grid.nx, grid.ny, grid.nz);
  const glm::dmat3 to_cells =
      glm::dmat3(glm::scale(glm::dmat4(1.0), cells)) * glm::inverse(glm::dmat3(volume.to_world));
  const glm::dmat3 rows = glm::transpose(to_cells);
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(float(rows[axis][k]))) return fail("a volume whose to_world has no inverse");
  Volume record{};
  record.corner = to_vec3(glm::dvec3(volume.to_world[3]) - center_);
  record.row_x = to_vec3(rows[0]);
  record.row_y = to_vec3(rows[1]);
  record.row_z = to_vec3(rows[2]);
  record.nx = grid.nx;
  record.ny = grid.ny;
  record.nz = grid.nz;
  record.channels = grid.channels;
  record.nearest = volume.nearest ? 1 : 0;
  record.fades = volume.fades ? 1 : 0;
  record.first_value = entry->second.first_value;
  record.first_majorant = entry->second.first_majorant;
  records.volumes.push_back(record);
  return int(records.volumes.size()) - 1;
}

}  // namespace penumbra
