// The scene as the kernels read it: one header and one flat array of 32-bit words. It is built once, from a
// scene description, by the scheduler, and shipped to every worker as it is, so that all of them trace the
// same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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

  /// Header and words with a magic number and a version in front; little-endian: `head` and then `body`.
  [[nodiscard]] std::vector<std::uint8_t> serialize() const;
  [[nodiscard]] std::vector<std::uint8_t> head() const;
  [[nodiscard]] std::span<const std::uint8_t> body() const;  ///< the words
  /// Checks magic, version, sizes and that every offset, index and count stays inside the data.
  static Expected<DeviceScene> deserialize(std::span<const std::uint8_t> bytes);
};

/// Takes a serialized scene in pieces, so that it is never there twice.
class DeviceSceneReader {
 public:
  /// `total`, where it is known: how many bytes there will be.
  explicit DeviceSceneReader(std::optional<std::size_t> total = {}) : total_(total) {}

  /// Errors: what DeviceScene::deserialize says of the beginning; no memory for what it announces.
  Expected<void> add(std::span<const std::uint8_t> bytes);
  /// After all pieces. Errors: as of DeviceScene::deserialize.
  Expected<DeviceScene> finish();

 private:
  Expected<void> begin();

  std::optional<std::size_t> total_;
  std::vector<std::uint8_t> head_;  ///< until it is whole
  std::size_t received_ = 0, expected_ = 0;
  DeviceScene scene_;
};

}  // namespace penumbra
