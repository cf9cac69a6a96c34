// The implementation of the module in vdb_module.h.
#include "scenes/vdb_module.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdint>
#include <mutex>
#include <sstream>
#include <vector>

namespace penumbra {
namespace {

constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 28;

float channel_of_number(float value, int) { return value; }
float channel_of_number(const openvdb::Vec3s& value, int channel) { return value[channel]; }

/// The names of the grids, for messages.
std::string names_of(const std::vector<openvdb::GridBase::Ptr>& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids) names.push_back(fmt::format("'{}'", grid->getName()));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The grid to be read.
Expected<openvdb::GridBase::Ptr> chosen(const openvdb::GridPtrVec& grids) {
  std::vector<openvdb::GridBase::Ptr> readable;
  for (const auto& grid : grids) {
    if (!grid->isType<openvdb::FloatGrid>() && !grid->isType<openvdb::Vec3SGrid>()) continue;
    if (grid->getName() == "density") return grid;
    readable.push_back(grid);
  }
  if (readable.empty())
    return fail(fmt::format("none of its {} grids has single-precision numbers or vectors", grids.size()));
  if (readable.size() > 1)
    return fail(fmt::format("it has the grids {}, none of which is 'density'", names_of(readable)));
  return readable.front();
}

template <typename Grid>
Expected<VolumeFile> dense(const Grid& grid, int channels) {
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
    return fail(fmt::format("its grid '{}' is a level set, a surface; a fog volume is read", grid.getName()));
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return fail(fmt::format("its grid '{}' has no active voxel", grid.getName()));
  const openvdb::Coord size = box.dim();
  // Sides are at most 2^32, so the first product does not overflow.
  const std::uint64_t layer = std::uint64_t(size.x()) * std::uint64_t(size.y());
  if (layer > kMostNumbers || layer * std::uint64_t(size.z()) * std::uint64_t(channels) > kMostNumbers)
    return fail(fmt::format(
        "the box of the active voxels of its grid '{}', {} x {} x {}, is larger than 2^28 numbers",
        grid.getName(), size.x(), size.y(), size.z()));
  const openvdb::math::Transform& place = grid.transform();
  const openvdb::Vec3d origin = place.indexToWorld(openvdb::Vec3d(0.0));
  VolumeFile file;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d one(0.0);
    one[axis] = 1;
    const openvdb::Vec3d step = place.indexToWorld(one) - origin;
    for (int other = 0; other < 3; ++other)
      if ((other == axis) != (step[other] > 0) || !place.isLinear() || step[other] < 0)
        return fail(
            fmt::format("its grid '{}' is placed by more than a scale and a translation; place it by "
                        "to_world",
                        grid.getName()));
    // Voxels are centred on grid points.
    file.low[axis] = origin[axis] + step[axis] * (double(box.min()[axis]) - 0.5);
    file.high[axis] = origin[axis] + step[axis] * (double(box.max()[axis]) + 0.5);
  }
  file.grid = {size.x(), size.y(), size.z(), channels, {}};
  file.grid.values.reserve(std::size_t(layer) * std::size_t(size.z()) * std::size_t(channels));
  const auto numbers = grid.getConstAccessor();
  openvdb::Coord at;
  for (at.z() = box.min().z(); at.z() <= box.max().z(); ++at.z())
    for (at.y() = box.min().y(); at.y() <= box.max().y(); ++at.y())
      for (at.x() = box.min().x(); at.x() <= box.max().x(); ++at.x())
        for (int k = 0; k < channels; ++k) {
          const float value = channel_of_number(numbers.getValue(at), k);
          if (!std::isfinite(value))
            return fail(fmt::format("the number of its grid '{}' at voxel {}, {}, {} is {}, not finite",
                                    grid.getName(), at.x(), at.y(), at.z(), value));
          file.grid.values.push_back(value);
        }
  return file;
}

Expected<VolumeFile> read_vdb(const std::string& bytes) {
  static std::once_flag once;
  std::call_once(once, openvdb::initialize);
  try {
    std::istringstream stream(bytes, std::ios::binary);
    openvdb::io::Stream file(stream, false);
    const auto grids = file.getGrids();
    if (!grids) return fail("it has no grids");
    const Expected<openvdb::GridBase::Ptr> grid = chosen(*grids);
    if (!grid) return std::unexpected(grid.error());
    if ((*grid)->isType<openvdb::FloatGrid>())
      return dense(*openvdb::gridPtrCast<openvdb::FloatGrid>(*grid), 1);
    return dense(*openvdb::gridPtrCast<openvdb::Vec3SGrid>(*grid), 3);
  } catch (const std::exception& wrong) {
    return fail(fmt::format("it cannot be read: {}", wrong.what()));
  }
}

}  // namespace
}  // namespace penumbra

extern "C" const penumbra::VdbReader penumbra_vdb_reader{penumbra::read_vdb};
