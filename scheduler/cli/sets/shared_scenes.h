// Lets several renders of a set share a scene, so that it is read once.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "scheduler/cli/loaded_scene.h"

namespace penumbra {

/// The largest total size of device scenes that are kept for later renders. Others are read again.
constexpr std::uint64_t kMostSharedBytes = std::uint64_t(2) << 30;

/// Renders that differ only in their samples or seed share a scene: the device scene depends on these only in
/// two numbers of its header. It is kept from the first of them to the last.
class SharedScenes {
 public:
  /// `renders`: the options of all renders of the set.
  explicit SharedScenes(const std::vector<const SceneOptions*>& renders,
                        std::uint64_t most_bytes = kMostSharedBytes);

  /// The result of `load_scene` and `reduce`, identical except for the time. To be called once for each
  /// render. If reading fails, the next render tries again.
  Expected<LoadedScene> load(const SceneOptions& options);

  [[nodiscard]] int reads() const { return reads_; }
  [[nodiscard]] std::uint64_t kept_bytes() const { return kept_bytes_; }

 private:
  struct Scene {
    int renders_to_come = 0;
    std::optional<LoadedScene> loaded = {};
    std::uint64_t bytes = 0;
  };

  std::map<SceneOptions, Scene> scenes_;  // keyed by everything on which they depend
  std::uint64_t most_bytes_, kept_bytes_ = 0;
  int reads_ = 0;
};

}  // namespace penumbra
