#include "scenes/volume_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "kernels/host/limited_child.h"
#include "kernels/host/module.h"
#include "scenes/vdb_module.h"

namespace penumbra {
namespace {

constexpr std::size_t kVolumeHeaderBytes = 48;

/// Converts 4-byte numbers from little-endian order.
template <typename T>
T little_endian(T value) {
  static_assert(sizeof(T) == 4);
  if constexpr (std::endian::native == std::endian::big)
    return std::bit_cast<T>(std::byteswap(std::bit_cast<std::uint32_t>(value)));
  return value;
}

template <typename T>
T volume_number_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return little_endian(value);
}

/// The names of Mitsuba 0.x's other encodings.
const char* encoding_name(std::int32_t encoding) {
  switch (encoding) {
    case 2:
      return " (half precision)";
    case 3:
      return " (bytes)";
    case 4:
      return " (directions)";
    default:
      return "";
  }
}

Expected<VolumeFile> read_vol(const std::string& name, std::string_view bytes) {
  const auto wrong = [&](const std::string& message) { return fail(fmt::format("{}: {}", name, message)); };
  if (bytes.size() < kVolumeHeaderBytes || !bytes.starts_with("VOL\3"))
    return wrong(
        "it is no volume file: neither of Mitsuba's, which begins with VOL and the version 3, nor of "
        "OpenVDB's");
  const auto encoding = volume_number_at<std::int32_t>(bytes, 4);
  if (encoding != 1)
    return wrong(fmt::format("its numbers have the encoding {}{}; 1, single precision, is read", encoding,
                             encoding_name(encoding)));
  VolumeFile file;
  VolumeGrid& grid = file.grid;
  std::size_t at = 8;
  for (int* size : {&grid.nx, &grid.ny, &grid.nz}) {
    *size = volume_number_at<std::int32_t>(bytes, at);
    at += 4;
    if (*size < 1) return wrong(fmt::format("the grid has {} points along an axis; it needs 1", *size));
  }
  grid.channels = volume_number_at<std::int32_t>(bytes, at);
  if (grid.channels != 1 && grid.channels != 3)
    return wrong(fmt::format("it has {} channels; 1 and 3 are read", grid.channels));
  // More than any file has, yet small enough that counts do not overflow.
  constexpr std::size_t kMost = std::size_t{1} << 60;
  std::size_t count = std::size_t(grid.channels);
  for (const int size : {grid.nx, grid.ny, grid.nz}) {
    if (count > kMost / std::size_t(size))
      return wrong(fmt::format("a grid of {} x {} x {} is too large", grid.nx, grid.ny, grid.nz));
    count *= std::size_t(size);
  }
  if (bytes.size() != kVolumeHeaderBytes + count * sizeof(float))
    return wrong(fmt::format("{} numbers take {} bytes after {} of others; there are {}", count,
                             count * sizeof(float), kVolumeHeaderBytes, bytes.size() - kVolumeHeaderBytes));
  for (int axis = 0; axis < 3; ++axis) {
    file.low[axis] = double(volume_number_at<float>(bytes, 24 + 4 * std::size_t(axis)));
    file.high[axis] = double(volume_number_at<float>(bytes, 36 + 4 * std::size_t(axis)));
  }
  grid.values.resize(count);
  std::memcpy(grid.values.data(), bytes.data() + kVolumeHeaderBytes, count * sizeof(float));
  if constexpr (std::endian::native == std::endian::big)
    for (float& value : grid.values) value = little_endian(value);
  const auto odd = std::ranges::find_if(grid.values, [](float value) { return !std::isfinite(value); });
  if (odd != grid.values.end())
    return wrong(fmt::format("the number at {} is {}, not finite",
                             place_in_grid(grid, std::size_t(odd - grid.values.begin())), *odd));
  return file;
}

/// Whether these are the first bytes of a .vdb or .nvdb file.
bool is_vdb(std::string_view bytes) {
  constexpr std::string_view kVdbMagic{" BDV\0\0\0\0", 8};
  return bytes.starts_with(kVdbMagic) || bytes.starts_with(kNanoVdbMagic);
}

/// What VdbReader writes. The process that wrote it may not have been sound.
Expected<VolumeFile> take_vdb(const ChildInput& input, bool may_be_empty) {
  const auto damaged = [] { return fail("it cannot be read: it is damaged"); };
  VdbHeader header;
  if (!input({reinterpret_cast<std::uint8_t*>(&header), sizeof header})) return damaged();
  const auto& [nx, ny, nz, channels, low, high] = header;
  if (may_be_empty && channels == 0) return VolumeFile();
  if (nx < 1 || ny < 1 || nz < 1 || (channels != 1 && channels != 3)) return damaged();
  std::uint64_t count = std::uint64_t(channels);
  for (const std::int32_t size : {nx, ny, nz}) {
    if (count > kMostVdbNumbers / std::uint64_t(size)) return damaged();
    count *= std::uint64_t(size);
  }
  VolumeFile file;
  file.grid = {nx, ny, nz, channels, std::vector<float>(count)};
  for (int axis = 0; axis < 3; ++axis) {
    file.low[axis] = low[std::size_t(axis)];
    file.high[axis] = high[std::size_t(axis)];
  }
  if (!input({reinterpret_cast<std::uint8_t*>(file.grid.values.data()), count * sizeof(float)}))
    return damaged();
  return file;
}

/// What a tree may take: of a small file as much as a picture of it should need, and of others far more than
/// compressed numbers become. Reading takes less than a second a megabyte.
ChildLimits limits_of(std::string_view bytes) {
  return {.memory_bytes = (std::uint64_t{768} << 20) + 256 * bytes.size(),
          .cpu_seconds = unsigned(4 + (bytes.size() >> 20))};
}

Expected<VolumeFile> read_vdb(const std::string& name, std::string_view bytes, std::string_view grid) {
  static const Expected<const void*> module = load_module("libpenumbra_vdb_reader.so", "penumbra_vdb_reader");
  if (!module)
    return fail(
        fmt::format("{}: files of OpenVDB's need a part of the program that is built where OpenVDB is: {}",
                    name, module.error().message));
  const auto* reader = static_cast<const VdbReader*>(*module);
  Expected<VolumeFile> file = VolumeFile();
  const Expected<void> done = run_limited(
      limits_of(bytes), [&](const ChildOutput& output) { return reader->read(bytes, grid, output); },
      [&](const ChildInput& input) -> Expected<void> {
        file = take_vdb(input, !grid.empty());
        if (!file) return std::unexpected(file.error());
        return {};
      });
  if (!done) file = std::unexpected(done.error());
  if (!file) return fail(fmt::format("{}: {}", name, file.error().message));
  return file;
}

}  // namespace

Expected<VolumeFile> read_volume_file(const std::string& name, std::string_view bytes) {
  return is_vdb(bytes) ? read_vdb(name, bytes, "") : read_vol(name, bytes);
}

Expected<VolumeFile> read_volume_grid(const std::string& name, std::string_view bytes,
                                      std::string_view grid) {
  if (is_vdb(bytes)) return read_vdb(name, bytes, grid);
  return VolumeFile();
}

std::string vol_of(const VolumeGrid& grid, const glm::dvec3& low, const glm::dvec3& high) {
  std::string out = "VOL\3";
  const auto put = [&](auto value) {
    value = little_endian(value);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const int number : {1, grid.nx, grid.ny, grid.nz, grid.channels}) put(std::int32_t(number));
  for (const glm::dvec3& corner : {low, high})
    for (int axis = 0; axis < 3; ++axis) put(float(corner[axis]));
  out.reserve(out.size() + grid.values.size() * sizeof(float));
  for (const float value : grid.values) put(value);
  return out;
}

std::string place_in_grid(const VolumeGrid& grid, std::size_t index) {
  const auto channels = std::size_t(grid.channels), nx = std::size_t(grid.nx), ny = std::size_t(grid.ny);
  const std::size_t cell = index / channels;
  std::string place = fmt::format("x {}, y {}, z {}", cell % nx, cell / nx % ny, cell / nx / ny);
  if (channels > 1) place += fmt::format(", channel {}", index % channels);
  return place;
}

}  // namespace penumbra
