// Scenes of a set that several renders share: read once.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "scheduler/cli/loaded_scene.h"

namespace penumbra {

/// Bytes of device scenes that wait for later renders, at most. What does not fit is read again.
constexpr std::uint64_t kMostSharedBytes = std::uint64_t(2) << 30;

/// Renders that differ in their samples or their seed alone have one scene: as the kernels read it, nothing
/// but two numbers of its header depends on them. It is kept from the first of them to the last.
class SharedScenes {
 public:
  /// Of all renders that will come.
  explicit SharedScenes(const std::vector<const SceneOptions*>& renders,
                        std::uint64_t most_bytes = kMostSharedBytes);

  /// What `load_scene` and `reduce` make of the options, byte for byte, but for the time. Once for each of
  /// the renders. A scene that cannot be read is tried again by the next one.
  Expected<LoadedScene> load(const SceneOptions& options);

  [[nodiscard]] int reads() const { return reads_; }
  [[nodiscard]] std::uint64_t kept_bytes() const { return kept_bytes_; }

 private:
  struct Scene {
    int renders_to_come = 0;
    std::optional<LoadedScene> loaded = {};
    std::uint64_t bytes = 0;
  };

  std::map<SceneOptions, Scene> scenes_;  // by all that they depend on
  std::uint64_t most_bytes_, kept_bytes_ = 0;
  int reads_ = 0;
};

}  // namespace penumbra
