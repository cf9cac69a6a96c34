// The .blend files that this process reads. Frames of a shot come from as few runs of Blender as possible: it
// exports what stays the same once, and goes on while the first frames are rendered.
#pragma once

#include <filesystem>
#include <list>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "scheduler/blender/blender_export.h"
#include "scheduler/render/render_request.h"

namespace penumbra {

class BlenderShots {
 public:
  BlenderShots() = default;
  /// Ends Blender and removes what it has exported.
  ~BlenderShots();

  /// Says which frames are going to be read, in this order. Others are exported alone. Those of other files
  /// do not count.
  void expect(const std::vector<const SceneOptions*>& renders);

  /// The exported scene of the options' frame. Thread-safe; one call waits for another. Errors: no Blender;
  /// a frame that is not whole or negative; Blender failed or was stopped. Where it ended at a frame, calls
  /// for others export them, and another call for that frame tries again.
  Expected<ExportedScene> scene_of(const SceneOptions& options);

 private:
  struct Shot {
    std::filesystem::path folder = {};
    std::set<int> expected = {};    // frames
    std::vector<int> to_come = {};  // those of them that nobody has asked for yet
    std::set<int> failed = {};      // those of which an error has been told
    std::list<BlenderExport> exports = {};
  };

  std::mutex mutex_;
  std::map<BlenderShot, Shot> shots_;
};

/// Those of this process.
BlenderShots& blender_shots();

}  // namespace penumbra
