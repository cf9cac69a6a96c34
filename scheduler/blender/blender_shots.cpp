#include "scheduler/blender/blender_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/scene_reader.h"
#include "scheduler/files/stop_signal.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

BlenderShot shot_of(const SceneOptions& options) {
  return {options.file, options.blender, options.blender_scene, options.camera, options.view_layer};
}

/// Blender's number of the frame; nothing without one. Error: it is not whole or negative.
Expected<std::optional<int>> frame_of(const SceneOptions& options) {
  if (!options.frame) return std::nullopt;
  const double frame = double(*options.frame) + options.frame_offset;
  if (frame < 0 || frame > double(kLastFrame) || frame != std::floor(frame))
    return fail(fmt::format("--frame-offset {:g}: frames of Blender's files are whole and from 0, not {:g}",
                            options.frame_offset, frame));
  return int(frame);
}

Expected<fs::path> make_folder() {
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  std::string folder = (temporary / "penumbra-blender-XXXXXX").string();
  if (error || mkdtemp(folder.data()) == nullptr)
    return fail(fmt::format("cannot make a folder for what Blender exports in {}", temporary.string()));
  return folder;
}

}  // namespace

BlenderShots::~BlenderShots() {
  for (auto& [shot, state] : shots_) {
    state.exports.clear();
    std::error_code ignored;
    if (!state.folder.empty()) fs::remove_all(state.folder, ignored);
  }
}

void BlenderShots::expect(const std::vector<const SceneOptions*>& renders) {
  const std::lock_guard lock(mutex_);
  std::map<std::string, bool> is_exported;
  for (const SceneOptions* options : renders) {
    const auto frame = frame_of(*options);
    if (!frame || !*frame) continue;
    const auto [known, is_new] = is_exported.try_emplace(options->file);
    if (is_new) known->second = is_exported_scene(options->file);
    if (!known->second) continue;
    Shot& shot = shots_[shot_of(*options)];
    if (shot.expected.insert(**frame).second) shot.to_come.push_back(**frame);
  }
}

Expected<ExportedScene> BlenderShots::scene_of(const SceneOptions& options) {
  const auto frame = frame_of(options);
  if (!frame) return std::unexpected(frame.error());
  const std::lock_guard lock(mutex_);
  Shot& shot = shots_[shot_of(options)];
  if (shot.folder.empty()) {
    const auto folder = make_folder();
    if (!folder) return std::unexpected(folder.error());
    shot.folder = *folder;
    install_stop_signal();  // so that Ctrl-C ends Blender and the folder
  }
  if (*frame) std::erase(shot.to_come, **frame);
  for (BlenderExport& each : shot.exports)
    if (each.has(*frame)) return each.frame(*frame);
  BlenderExport* run = shot.exports.empty() ? nullptr : &shot.exports.back();
  const auto answer = [&] {
    auto scene = run->frame(*frame);
    if (!scene && *frame) shot.failed.insert(**frame);
    return scene;
  };
  const bool is_told = *frame && shot.failed.contains(**frame);
  if (run != nullptr && run->is_over() && run->ended_at(*frame) && !is_told) return answer();
  // Where Blender has never exported a frame, it would not now.
  const bool has_exported =
      std::ranges::any_of(shot.exports, [](const auto& each) { return each.exported() > 0; });
  const bool is_needed = run == nullptr || (run->is_over() ? has_exported : !run->promises(*frame));
  if (is_needed) {
    std::vector<int> frames;
    if (*frame) frames.push_back(**frame);
    if (*frame && (run == nullptr || run->is_over()))
      frames.insert(frames.end(), shot.to_come.begin(), shot.to_come.end());
    const int number = int(shot.exports.size());
    run = &shot.exports.emplace_back(shot_of(options), std::move(frames), shot.folder, number);
  }
  return answer();
}

BlenderShots& blender_shots() {
  static BlenderShots shots;
  return shots;
}

}  // namespace penumbra
