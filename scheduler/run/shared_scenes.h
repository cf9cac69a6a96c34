// Lets several renders of a set share a scene, so that it is read once.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "scheduler/run/loaded_scene.h"
#include "scheduler/run/scene_file.h"

namespace penumbra {

/// The largest total size of device scenes that are kept for later renders. Others are read again.
constexpr std::uint64_t kMostSharedBytes = std::uint64_t(2) << 30;

/// Renders that differ only in their samples or seed share a device scene, which depends on these only in two
/// numbers of its header. Frames of a shot share its description, unless the file has $frame or $time, and
/// renders that differ in settings what the file says. All are kept from the first of these renders to the
/// last.
class SharedScenes {
 public:
  /// `renders`: the options of all renders of the set.
  explicit SharedScenes(const std::vector<const SceneOptions*>& renders,
                        std::uint64_t most_bytes = kMostSharedBytes);

  /// The result of load_reduced_scene, identical except for the time. To be called once for each
  /// render. If reading fails, the next render tries again.
  Expected<LoadedScene> load(const SceneOptions& options);

  [[nodiscard]] int reads() const { return reads_; }
  [[nodiscard]] std::uint64_t kept_bytes() const { return kept_bytes_; }

 private:
  struct Shot {
    int renders_to_come = 0;
    std::optional<ReadScene> scene = {};          ///< at the time of the frame that was loaded last
    std::uint32_t seed = 0;                       ///< of the scene, without the frame
    std::shared_ptr<const KeptFrame> frame = {};  ///< the first; which one makes no difference
    std::uint64_t bytes = 0;
  };
  Expected<LoadedScene> load_frame(const SceneOptions& options, Shot& shot);
  void keep(const SceneOptions& options, Shot& shot, ReadScene scene);
  void forget(Shot& shot);

  struct File {
    int scenes_to_come = 0;
    std::optional<SceneFile> content = {};
    std::uint64_t bytes = 0;
  };
  Expected<LoadedScene> load_from(File& file, const SceneOptions& options);

  struct Scene {
    int renders_to_come = 0;
    bool was_loaded = false;
    std::optional<LoadedScene> loaded = {};
    std::uint64_t bytes = 0;
  };

  std::map<SceneOptions, Scene> scenes_;  // keyed by everything on which they depend
  std::map<SceneOptions, Shot> shots_;    // keyed by all of that but the frame
  std::map<SceneOptions, File> files_;    // keyed by SceneFile::reading_of
  std::uint64_t most_bytes_, kept_bytes_ = 0;
  int reads_ = 0;
};

}  // namespace penumbra
