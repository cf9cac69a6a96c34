// The scene as the kernels read it: one header and one flat array of 32-bit words. It is built once, from a
// scene description, by the scheduler, and shipped to every worker as it is, so that all of them trace the
// same bits.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/cache_aligned.h"
#include "kernels/host/error.h"
#include "kernels/scene_types.h"

namespace penumbra {

/// Paths that a thread of a CPU has under way at once: enough that compaction leaves few lanes idle, few
/// enough that their state shares a second-level cache of 1 MiB with the scene. 512 are 20 % slower, 8192
/// some 5 %.
constexpr int kBlockPaths = 2048;
constexpr std::uint32_t kMaxSamplesPerUnit = 4096;  ///< a block holds all samples of a pixel at once

struct DeviceScene {
  SceneHeader header{};
  AlignedVector<std::uint32_t> words;  ///< the tables whose offsets the header holds

  /// Header and words with a magic number and a version in front; little-endian.
  [[nodiscard]] std::vector<std::uint8_t> serialize() const;
  /// Checks magic, version, sizes and that every offset, index and count stays inside the data.
  static Expected<DeviceScene> deserialize(std::span<const std::uint8_t> bytes);
};

}  // namespace penumbra
