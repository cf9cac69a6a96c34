// A scene file that was read once, for renders that differ in settings.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "kernels/host/file_stamp.h"
#include "scheduler/run/loaded_scene.h"

namespace penumbra {

/// The size of the description's large parts, in bytes.
std::uint64_t bytes_of(const SceneDescription& scene);

class SceneFile {
 public:
  /// The options by which files are read: all but settings.
  static SceneOptions reading_of(SceneOptions options);
  /// Whether renders with these options can share a file: no frames of shots, no warnings that count as
  /// errors.
  static bool is_shareable(const SceneOptions& options);

  /// Errors: as of read_scene; also of a file that another program exports, or that is valid only with some
  /// settings.
  static Expected<SceneFile> read(const SceneOptions& options);

  /// The result of load_reduced_scene, identical except for the time, and for warnings of values that
  /// settings replace.
  Expected<LoadedScene> load(const SceneOptions& options);

  /// Whether all files of the scene are as they were when it was read, and were that old then that their
  /// times tell.
  [[nodiscard]] bool is_unchanged() const;
  /// Of the large parts, also of the device scene that was loaded first.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  SceneFile(ReadScene scene, std::filesystem::file_time_type begin);
  [[nodiscard]] std::vector<FileStamp> stamps() const;

  ReadScene scene_;
  RenderSettings settings_;  ///< of the file
  std::vector<std::string> warnings_;
  std::filesystem::file_time_type begin_;  ///< of reading
  std::vector<FileStamp> stamps_;
  std::shared_ptr<const KeptFrame> device_ = {};  ///< the first; which one makes no difference
};

/// Keeps the files of the scenes that were loaded last, as long as they do not change.
class KeptSceneFiles {
 public:
  explicit KeptSceneFiles(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}
  /// As SceneFile::load, also of scenes that cannot be kept.
  Expected<LoadedScene> load(const SceneOptions& options);
  [[nodiscard]] int reads() const { return reads_; }

 private:
  struct Kept {
    SceneOptions reading;
    SceneFile file;
  };
  std::vector<Kept> kept_;  ///< the last that was used is the last
  std::uint64_t most_bytes_;
  int reads_ = 0;
};

}  // namespace penumbra
