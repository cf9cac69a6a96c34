#include "scheduler/run/scene_file.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "kernels/host/process.h"
#include "scenes/instances.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

/// A file that is written twice within it may have the same time after both.
constexpr std::chrono::milliseconds kClockStep{20};

std::uint64_t bytes_of_geometry(const Geometry& geometry) {
  if (const auto* curves = std::get_if<Curves>(&geometry)) {
    std::uint64_t points = 0;
    for (const Curve& curve : curves->curves) points += sizeof curve + curve.size() * sizeof curve[0];
    return points;
  }
  const auto* mesh = std::get_if<Mesh>(&geometry);
  if (mesh == nullptr) return sizeof geometry;
  const auto bytes = [](const auto& values) { return values.size() * sizeof values[0]; };
  return bytes(mesh->positions) + bytes(mesh->normals) + bytes(mesh->texcoords) + bytes(mesh->colours) +
         bytes(mesh->triangles) + bytes(mesh->face_colours) + bytes(mesh->tangents);
}

}  // namespace

std::uint64_t bytes_of(const SceneDescription& scene) {
  std::uint64_t bytes = 0;
  each_shape(scene, [&](const Shape& shape) { bytes += bytes_of_geometry(shape.geometry); });
  if (scene.motion != nullptr)
    for (const MovingShape& moving : scene.motion->shapes) {
      bytes += bytes_of_geometry(moving.rest);
      if (moving.deformation == nullptr) continue;
      bytes += moving.deformation->skin.influences.size() * sizeof(Skin::Influence);
      for (const MorphTarget& target : moving.deformation->targets)
        bytes +=
            (target.positions.size() + target.normals.size() + target.tangents.size()) * sizeof(glm::dvec3);
    }
  for (const auto& bitmap : scene.bitmaps) bytes += bitmap->words.size() * sizeof bitmap->words[0];
  return bytes;
}

SceneOptions SceneFile::reading_of(SceneOptions options) {
  const SceneOptions all = std::exchange(options, {.file = options.file});
  options.defines = all.defines;
  options.camera = all.camera;
  options.lenient = all.lenient;
  options.dialect = all.dialect;
  options.clip = all.clip;
  options.fps = all.fps;
  options.integrator = all.integrator;
  options.sampler = all.sampler;
  std::ranges::copy_if(all.settings, std::back_inserter(options.settings), [](const std::string& setting) {
    const std::string key = to_snake_case(setting.substr(0, setting.find('=')));
    return key == "integrator.type" || key == "sampler.type";
  });
  return options;
}

bool SceneFile::is_shareable(const SceneOptions& options) { return !options.frame && !options.strict; }

Expected<SceneFile> SceneFile::read(const SceneOptions& options) {
  const auto begin = std::filesystem::file_time_type::clock::now();
  auto scene = read_scene_file(reading_of(options));
  if (!scene) return std::unexpected(scene.error());
  return SceneFile(std::move(*scene), begin);
}

SceneFile::SceneFile(ReadScene scene, std::filesystem::file_time_type begin)
    : scene_(std::move(scene)),
      settings_(scene_.description),
      warnings_(scene_.description.warnings),
      begin_(begin),
      stamps_(stamps()) {}

Expected<LoadedScene> SceneFile::load(const SceneOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  SceneDescription& description = scene_.description;
  static_cast<RenderSettings&>(description) = settings_;
  description.warnings = warnings_;
  if (auto completed = complete_scene(scene_, options); !completed) return std::unexpected(completed.error());
  auto loaded = build_scene(scene_, options, device_);
  if (!loaded) return loaded;
  reduce(*loaded, description);
  if (device_ == nullptr)
    device_ = std::make_shared<const KeptFrame>(KeptFrame{loaded->device, manifest_of(loaded->device)});
  loaded->kept = device_;
  loaded->seconds = seconds_since(begin);
  return loaded;
}

bool SceneFile::is_unchanged() const {
  const auto is_old = [&](const FileStamp& stamp) { return stamp.time + kClockStep < begin_; };
  return std::ranges::all_of(stamps_, is_old) && stamps_ == stamps();
}

std::uint64_t SceneFile::bytes() const {
  const std::size_t words = device_ != nullptr ? device_->scene.words.size() : 0;
  return bytes_of(scene_.description) + words * sizeof(std::uint32_t);
}

std::vector<FileStamp> SceneFile::stamps() const {
  std::vector<FileStamp> all;
  for (const std::filesystem::path& file : scene_.description.files) all.push_back(stamp_of(file));
  return all;
}

Expected<LoadedScene> KeptSceneFiles::load(const SceneOptions& options) {
  const auto load_alone = [&] { return ++reads_, load_reduced_scene(options); };
  if (!SceneFile::is_shareable(options)) return load_alone();
  const SceneOptions reading = SceneFile::reading_of(options);
  std::erase_if(kept_, [](const Kept& each) { return !each.file.is_unchanged(); });
  auto found = std::ranges::find(kept_, reading, &Kept::reading);
  if (found == kept_.end()) {
    auto file = SceneFile::read(options);
    if (!file) return load_alone();
    ++reads_;
    kept_.push_back({reading, std::move(*file)});
    found = std::prev(kept_.end());
  }
  std::rotate(found, found + 1, kept_.end());
  auto scene = kept_.back().file.load(options);
  std::uint64_t bytes = 0;
  const auto first_kept = std::find_if(kept_.rbegin(), kept_.rend(), [&](const Kept& each) {
                            return (bytes += each.file.bytes()) > most_bytes_;
                          }).base();
  kept_.erase(kept_.begin(), first_kept);
  return scene;
}

}  // namespace penumbra
