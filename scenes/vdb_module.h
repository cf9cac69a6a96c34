// The interface to OpenVDB files (.vdb) and NanoVDB files (.nvdb): reads the grid of a medium. The code lives
// in a separate module. It is loaded when a scene refers to such a file, and it exists only if OpenVDB was
// present when the renderer was built.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// The first bytes of a NanoVDB file, before a number of its kind.
constexpr std::string_view kNanoVdbMagic = "NanoVDB";

/// The most numbers of a box.
constexpr std::uint64_t kMostVdbNumbers = std::uint64_t{1} << 28;

/// A box of numbers and its position, before the numbers themselves.
struct VdbHeader {
  std::int32_t nx = 0, ny = 0, nz = 0, channels = 0;
  std::array<double, 3> low{}, high{};
};

/// The interface that the module exports under the name penumbra_vdb_reader.
struct VdbReader {
  /// Reads the grid of that name. Without a name, that named "density", or else the file's only grid of
  /// floats or of vectors of three. Writes the bounding box of its active voxels as a dense grid: VdbHeader,
  /// then the numbers, x fastest; if there is no grid of the name, or it has no active voxel, an empty
  /// VdbHeader. OpenVDB trusts its input: of a damaged file it may write anywhere in memory, so this is
  /// called in a process of its own. Errors: no such grid, a level set, a transform that rotates, shears or
  /// mirrors the box, more than kMostVdbNumbers in the box, a number that is not finite, a damaged file or
  /// one that ends early.
  Expected<void> (*read)(std::string_view bytes, std::string_view name,
                         const std::function<bool(std::span<const std::uint8_t>)>& write);
};

}  // namespace penumbra
