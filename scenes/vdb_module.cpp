// The implementation of the module in vdb_module.h.
#include "scenes/vdb_module.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <vector>

#include "scenes/nanovdb_grids.h"
#include "scenes/vdb_stream.h"

namespace penumbra {
namespace {

using Write = std::function<bool(std::span<const std::uint8_t>)>;

template <typename Value>
bool write_values(const Write& write, std::span<const Value> values) {
  return write({reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()});
}

float channel_of_number(float value, int) { return value; }
float channel_of_number(const openvdb::Vec3s& value, int channel) { return value[channel]; }

/// The names of the grids, for messages.
std::string names_of(const std::vector<openvdb::GridBase::Ptr>& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids) names.push_back(fmt::format("'{}'", grid->getName()));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The grid to be read, null if there is none of that name.
Expected<openvdb::GridBase::Ptr> chosen(const openvdb::GridPtrVec& grids, std::string_view name) {
  std::vector<openvdb::GridBase::Ptr> readable;
  for (const auto& grid : grids) {
    if (!grid->isType<openvdb::FloatGrid>() && !grid->isType<openvdb::Vec3SGrid>()) continue;
    if (grid->getName() == (name.empty() ? "density" : name)) return grid;
    readable.push_back(grid);
  }
  if (!name.empty()) return openvdb::GridBase::Ptr();
  if (readable.empty())
    return fail(fmt::format("none of its {} grids has single-precision numbers or vectors", grids.size()));
  if (readable.size() > 1)
    return fail(fmt::format("it has the grids {}, none of which is 'density'", names_of(readable)));
  return readable.front();
}

Expected<void> write_nothing(const Write& write) {
  const VdbHeader header;
  if (!write_values(write, std::span<const VdbHeader>(&header, 1))) return fail("nobody reads it");
  return {};
}

template <typename Grid>
Expected<void> write_dense(const Grid& grid, int channels, bool may_be_empty, const Write& write) {
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
    return fail(fmt::format("its grid '{}' is a level set, a surface; a fog volume is read", grid.getName()));
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty() && may_be_empty) return write_nothing(write);
  if (box.empty()) return fail(fmt::format("its grid '{}' has no active voxel", grid.getName()));
  const openvdb::Coord size = box.dim();
  // Sides are at most 2^32, so the first product does not overflow.
  const std::uint64_t layer = std::uint64_t(size.x()) * std::uint64_t(size.y());
  if (layer > kMostVdbNumbers || layer * std::uint64_t(size.z()) * std::uint64_t(channels) > kMostVdbNumbers)
    return fail(fmt::format(
        "the box of the active voxels of its grid '{}', {} x {} x {}, is larger than 2^28 numbers",
        grid.getName(), size.x(), size.y(), size.z()));
  const openvdb::math::Transform& place = grid.transform();
  const openvdb::Vec3d origin = place.indexToWorld(openvdb::Vec3d(0.0));
  VdbHeader header{size.x(), size.y(), size.z(), channels};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d one(0.0);
    one[int(axis)] = 1;
    const openvdb::Vec3d step = place.indexToWorld(one) - origin;
    for (int other = 0; other < 3; ++other)
      if ((other == int(axis)) != (step[other] > 0) || !place.isLinear() || step[other] < 0)
        return fail(
            fmt::format("its grid '{}' is placed by more than a scale and a translation; place it by "
                        "to_world",
                        grid.getName()));
    // Voxels are centred on grid points.
    const int k = int(axis);
    header.low[axis] = origin[k] + step[k] * (double(box.min()[k]) - 0.5);
    header.high[axis] = origin[k] + step[k] * (double(box.max()[k]) + 0.5);
  }
  if (!write_values(write, std::span<const VdbHeader>(&header, 1))) return fail("nobody reads it");
  std::vector<float> row;
  const auto numbers = grid.getConstAccessor();
  openvdb::Coord at;
  for (at.z() = box.min().z(); at.z() <= box.max().z(); ++at.z())
    for (at.y() = box.min().y(); at.y() <= box.max().y(); ++at.y()) {
      row.clear();
      for (at.x() = box.min().x(); at.x() <= box.max().x(); ++at.x())
        for (int k = 0; k < channels; ++k) {
          const float value = channel_of_number(numbers.getValue(at), k);
          if (!std::isfinite(value))
            return fail(fmt::format("the number of its grid '{}' at voxel {}, {}, {} is {}, not finite",
                                    grid.getName(), at.x(), at.y(), at.z(), value));
          row.push_back(value);
        }
      if (!write_values(write, std::span<const float>(row))) return fail("nobody reads it");
    }
  return {};
}

/// Reads grids in their order as openvdb::io::Stream does, and checks lengths before OpenVDB believes them.
class CheckedArchive : public openvdb::io::Archive {
 public:
  openvdb::GridPtrVec read(VdbStream& stream) {
    readHeader(stream);
    setFormatVersion(stream);
    setLibraryVersion(stream);
    setDataCompression(stream);
    check_vdb_metadata(stream.left());
    openvdb::MetaMap().readMeta(stream);
    std::vector<openvdb::io::GridDescriptor> descriptors;
    openvdb::GridPtrVec grids;
    NamedGridMap by_name;
    const std::int32_t count = readGridCount(stream);
    for (std::int32_t i = 0; i < count; ++i) {
      check_vdb_grid(stream.left(), fileVersion());
      openvdb::io::GridDescriptor descriptor;
      const openvdb::GridBase::Ptr grid = descriptor.read(stream);
      readGrid(grid, descriptor, stream);
      grids.push_back(grid);
      by_name[descriptor.uniqueName()] = grid;
      descriptors.push_back(descriptor);
    }
    for (const auto& descriptor : descriptors) connectInstance(descriptor, by_name);
    return grids;
  }
};

Expected<openvdb::GridPtrVec> grids_of(std::string_view bytes) {
  if (bytes.starts_with(kNanoVdbMagic)) return nanovdb_grids(bytes);
  VdbStream stream(bytes);
  return CheckedArchive().read(stream);
}

Expected<void> read_vdb(std::string_view bytes, std::string_view name, const Write& write) {
  static std::once_flag once;
  std::call_once(once, [] {
    openvdb::initialize();
    // It only says how to read parts of a file, and its lengths are not checked.
    openvdb::Metadata::unregisterType("__delayedload");
  });
  try {
    const Expected<openvdb::GridPtrVec> grids = grids_of(bytes);
    if (!grids) return std::unexpected(grids.error());
    if (grids->empty()) return fail("it has no grids");
    const Expected<openvdb::GridBase::Ptr> grid = chosen(*grids, name);
    if (!grid) return std::unexpected(grid.error());
    if (*grid == nullptr) return write_nothing(write);
    if ((*grid)->isType<openvdb::FloatGrid>())
      return write_dense(*openvdb::gridPtrCast<openvdb::FloatGrid>(*grid), 1, !name.empty(), write);
    return write_dense(*openvdb::gridPtrCast<openvdb::Vec3SGrid>(*grid), 3, !name.empty(), write);
  } catch (const std::ios_base::failure&) {
    return fail("it cannot be read: the file ends early, or a length in it is damaged");
  } catch (const std::exception& wrong) {
    return fail(fmt::format("it cannot be read: {}", wrong.what()));
  }
}

}  // namespace
}  // namespace penumbra

extern "C" const penumbra::VdbReader penumbra_vdb_reader{penumbra::read_vdb};
