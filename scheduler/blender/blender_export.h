// One run of Blender that exports frames of a .blend file, each of which can be read as soon as it is there.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_reader.h"

namespace penumbra {

/// What frames of one export have in common.
struct BlenderShot {
  std::string file = {};
  std::string program = {};                         ///< --blender
  std::string scene = {}, camera = {}, layer = {};  ///< names; empty: the file's

  friend auto operator<=>(const BlenderShot&, const BlenderShot&) = default;
};

class BlenderExport {
 public:
  /// Starts Blender, which exports the frames in this order to the folder; none: the file's current one.
  /// `number` tells apart the exports to one folder.
  BlenderExport(const BlenderShot& shot, std::vector<int> frames, std::filesystem::path folder, int number);
  BlenderExport(const BlenderExport&) = delete;
  BlenderExport& operator=(const BlenderExport&) = delete;
  /// Ends Blender.
  ~BlenderExport();

  /// Waits for the frame; nothing: the file's current one. Errors: Blender ended without it, and why.
  Expected<ExportedScene> frame(std::optional<int> frame);

  /// Whether the frame is there.
  bool has(std::optional<int> frame);
  /// Whether it is among those that were asked for.
  [[nodiscard]] bool promises(std::optional<int> frame) const;
  /// Whether it is the first that was asked for and is not there.
  bool ended_at(std::optional<int> frame);
  /// Whether Blender has ended.
  [[nodiscard]] bool is_over() const { return is_over_; }
  /// How many frames are there, as far as has been looked.
  [[nodiscard]] std::size_t exported() const { return scenes_.size(); }

 private:
  void run(const BlenderShot& shot);
  /// Reads what Blender has reported since the last time.
  void read_results();

  const std::vector<int> frames_;
  const std::filesystem::path folder_, results_;
  std::size_t read_ = 0;  // bytes of the results
  std::map<int, ExportedScene> scenes_;
  std::string reported_;  // the error that the script reports
  std::atomic<bool> is_over_ = false, is_unwanted_ = false;
  Expected<void> ended_;  // written before is_over_
  std::jthread blender_;  // Blender ends with the thread that has started it
};

}  // namespace penumbra
