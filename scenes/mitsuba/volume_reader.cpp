#include "scenes/mitsuba/volume_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/transform.h"
#include "scenes/volumes.h"

namespace penumbra::mitsuba {
namespace {

/// The transform from the unit cube to the box in the file. Errors: the box is not valid.
Expected<glm::dmat4> box_of(const VolumeFile& file) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(file.low[axis] < file.high[axis] && std::isfinite(file.high[axis] - file.low[axis])))
      return fail(fmt::format("the box that the file says is none: it goes from {} to {} along {}",
                              file.low[axis], file.high[axis], "xyz"[axis]));
  return translation(file.low) * scaling(file.high - file.low);
}

/// The box that a file of Mitsuba 0.x means: its own, or that between the points min and max.
VolumeFile moved(PluginReader& plugin, const VolumeFile& file) {
  VolumeFile result;
  const auto low = plugin.point("min"), high = plugin.point("max");
  if (low.has_value() != high.has_value())
    plugin.warn("min and max count together only, as in Mitsuba 0.x; the file's box does");
  result.low = low && high ? *low : file.low;
  result.high = low && high ? *high : file.high;
  return result;
}

/// From the box whose corners are the centres of the outermost cells to the one that the cells fill.
glm::dmat4 around_corners(const VolumeGrid& grid) {
  const glm::dvec3 cells(grid.nx, grid.ny, grid.nz), half(0.5);
  return translation(half) * scaling(cells / (cells - 1.0)) * translation(-half);
}

/// The file's grid within a layer of cells of value 0, and its box, which is larger by them. Errors: more
/// cells than an int counts.
Expected<VolumeFile> with_border(const std::string& name, const VolumeFile& file) {
  const VolumeGrid& grid = file.grid;
  if (std::max({grid.nx, grid.ny, grid.nz}) > std::numeric_limits<int>::max() - 2)
    return fail(fmt::format("{}: its grid is too large for a border", name));
  const glm::ivec3 cells(grid.nx, grid.ny, grid.nz);
  const glm::dvec3 cell = (file.high - file.low) / glm::dvec3(cells);
  VolumeFile larger{
      {grid.nx + 2, grid.ny + 2, grid.nz + 2, grid.channels, {}}, file.low - cell, file.high + cell};
  const auto channels = std::size_t(grid.channels), row = std::size_t(grid.nx) * channels;
  const auto wide = std::size_t(larger.grid.nx) * channels, high = std::size_t(larger.grid.ny);
  larger.grid.values.resize(wide * high * std::size_t(larger.grid.nz));
  for (std::size_t z = 0; z < std::size_t(grid.nz); ++z)
    for (std::size_t y = 0; y < std::size_t(grid.ny); ++y)
      std::copy_n(grid.values.begin() + std::ptrdiff_t((z * std::size_t(grid.ny) + y) * row), row,
                  larger.grid.values.begin() + std::ptrdiff_t(((z + 1) * high + y + 1) * wide + channels));
  return larger;
}

/// From the unit cube that the cells of a file fill to that of its grid with a border.
glm::dmat4 around_border(const VolumeGrid& larger) {
  const glm::dvec3 cells(larger.nx, larger.ny, larger.nz), half(0.5);
  return translation(half) * scaling(cells / (cells - 2.0)) * translation(-half);
}

}  // namespace

std::optional<GridVolume> VolumeReader::read(const Context& context, const Object& object,
                                             std::string_view name, const VolumeColour& values) {
  PluginReader plugin(context, object);
  GridVolumeParameters given;
  plugin.read_parameters(given);
  // In Mitsuba 0.x, the grid's numbers are at the corners of its cells, and the file says where it is.
  const bool at_corners = context.tree.major_version < 2;
  if (at_corners) plugin.accept({"min", "max", "send_data"});
  // Parameters of Mitsuba's spectral variants, GPU backends and sampling.
  plugin.accept({"raw", "accel", "max_value"});
  plugin.finish();
  const bool has_border = given.wrap == GridVolumeParameters::kZero;
  const File file = open(context, plugin, given.filename, has_border);
  if (file == nullptr) return std::nullopt;
  const VolumeGrid& grid = file->grid;
  const auto odd = std::ranges::find_if(grid.values, [&](float value) { return !values.contains(value); });
  if (odd != grid.values.end()) {
    plugin.wrong("filename", fmt::format("{}: the number at {} is {}; {} must be a {}", given.filename,
                                         place_in_grid(grid, std::size_t(odd - grid.values.begin())), *odd,
                                         name, values.values()));
    return std::nullopt;
  }
  GridVolume volume{{file, &grid}, given.to_world, given.nearest};
  if (at_corners && std::min({grid.nx, grid.ny, grid.nz}) < 2) {
    plugin.wrong("filename",
                 fmt::format("{}: a grid of {} x {} x {} numbers; of Mitsuba 0.x it needs two along "
                             "each axis, at the corners of its cells",
                             given.filename, grid.nx, grid.ny, grid.nz));
    return std::nullopt;
  }
  if (has_border && at_corners) {
    plugin.wrong("wrap_mode", "zero is for scenes of version 2 and later");
    return std::nullopt;
  }
  if (has_border && !given.use_grid_bbox) volume.to_world = given.to_world * around_border(grid);
  if (given.use_grid_bbox || at_corners) {
    const auto box = at_corners ? box_of(moved(plugin, *file)) : box_of(*file);
    if (!box) {
      plugin.wrong("filename", fmt::format("{}: {}", given.filename, box.error().message));
      return std::nullopt;
    }
    volume.to_world = given.to_world * *box;
    if (at_corners) {
      volume.to_world = volume.to_world * around_corners(grid);
      context.diagnostics.warn_counted(object.location,
                                       "a grid of Mitsuba 0.x ends at its outermost numbers; here it goes on "
                                       "for half a cell where the medium's shape is larger");
    }
    if (is_singular(volume.to_world)) {
      plugin.wrong("to_world", "the transform of the box that the file says overflows");
      return std::nullopt;
    }
  }
  return volume;
}

VolumeReader::File VolumeReader::open(const Context& context, PluginReader& plugin,
                                      const std::string& filename, bool has_border) {
  if (!plugin.has("filename")) {
    plugin.wrong(fmt::format("{} needs a <string name=\"filename\" …>", plugin.title()));
    return nullptr;
  }
  const auto path = context.files->find(filename, context.folders(plugin.object()));
  if (!path) {
    plugin.wrong("filename", path.error().message);
    return nullptr;
  }
  std::error_code ignored;
  const std::pair key(std::filesystem::weakly_canonical(*path, ignored).string(), has_border);
  auto known = files_.find(key);
  if (known == files_.end()) known = files_.emplace(key, read_new(*context.files, *path, has_border)).first;
  if (known->second) return *known->second;
  context.diagnostics.error_text(fmt::format("{}\n  (which is named at {})", known->second.error().message,
                                             describe(plugin.object().location)));
  return nullptr;
}

Expected<VolumeReader::File> VolumeReader::read_new(const FileAccess& files,
                                                    const std::filesystem::path& path, bool has_border) {
  const Expected<std::string> bytes = files.read_bytes(path, kMaxVolumeFileBytes);
  if (!bytes) return std::unexpected(bytes.error());
  Expected<VolumeFile> file = read_volume_file(path.string(), *bytes);
  if (file && has_border) file = with_border(path.string(), *file);
  if (!file) return std::unexpected(file.error());
  return std::make_shared<const VolumeFile>(std::move(*file));
}

}  // namespace penumbra::mitsuba
