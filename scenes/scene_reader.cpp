#include "scenes/scene_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include "scenes/diagnostic.h"
#include "scenes/file_access.h"
#include "scenes/gltf/gltf_scene.h"
#include "scenes/instances.h"
#include "scenes/mitsuba/mitsuba_scene.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/names.h"
#include "scenes/nori/nori_scene.h"
#include "scenes/pbrt/pbrt_scene.h"
#include "scenes/rainbow/rainbow_scene.h"
#include "scenes/settings.h"
#include "scenes/tinyrender/tinyrender_scene.h"

namespace penumbra {
namespace {

/// A scene format. A new format needs one more row here.
struct Format {
  std::string name;
  std::string extension;
  /// The first character after white space and comment lines; used if the extension is unknown.
  char first_character;
  std::function<Expected<SceneDescription>(const std::filesystem::path&, const ReadOptions&)> read;
  /// For formats that share an extension: whether the file has this format. Empty: all files that match no
  /// other.
  std::function<bool(const std::filesystem::path&)> is_one = {};
  bool has_dialects = false;
  bool has_clips = false;
  bool is_exported = false;  ///< by another program; `read` is empty

  [[nodiscard]] bool may_be(const std::filesystem::path& file) const { return !is_one || is_one(file); }
};

std::span<const Format> formats() {
  static const std::vector<Format> table = {
      {"Rainbow XML", ".xml", '<', rainbow::read_scene, rainbow::is_scene},
      {"Nori XML", ".xml", '<', nori::read_scene, nori::is_scene, true},
      {"Mitsuba XML", ".xml", '<', mitsuba::read_scene},
      {"TinyRender TOML", ".toml", '[', tinyrender::read_scene},
      {"glTF 2.0", ".gltf", '{', gltf::read_scene, {}, false, true},
      {"glTF 2.0 binary", ".glb", 'g', gltf::read_scene, {}, false, true},
      {"pbrt-v4", ".pbrt", 'W', pbrt::read_scene},
      {"Blender", ".blend", 'B', {}, {}, false, false, true}};
  return table;
}

/// The first character after a byte order mark, white space, and comment lines, with which TOML files may
/// begin.
char first_character(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  for (const int byte : {0xEF, 0xBB, 0xBF}) {
    if (stream.peek() == byte) stream.get();
  }
  char c = '\0';
  while (stream >> c && c == '#') stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  return stream ? c : '\0';
}

const Format* format_of(const std::filesystem::path& file) {
  const std::string extension = extension_of(extension_of(file) == ".gz" ? file.stem() : file);
  for (const Format& each : formats()) {
    if (each.extension == extension && each.may_be(file)) return &each;
  }
  const char first = first_character(file);
  for (const Format& each : formats()) {
    if (each.first_character == first && each.may_be(file)) return &each;
  }
  return nullptr;
}

/// Applies settings in the order of the table, so that the order in which they were given does not matter. If
/// a key was given twice, the last is used.
Expected<void> apply_all(SceneDescription& scene, const ReadOptions& options, std::string_view prefix = "") {
  std::map<std::ptrdiff_t, std::pair<std::string, std::string>> in_order;
  for (const auto& [key, value] : options.settings) {
    if (!to_snake_case(key).starts_with(prefix)) continue;
    const Setting* found = find_setting(to_snake_case(key));
    in_order[found != nullptr ? found - all_settings().data() : -1] = {key, value};
  }
  for (const auto& [position, setting] : in_order) {
    if (auto done = apply_setting(scene, setting.first, setting.second); !done) return done;
  }
  return check_settings(scene);
}

bool has_light(const SceneDescription& scene) {
  bool shines = false;
  each_shape(scene,
             [&](const Shape& s) { shines = shines || (s.radiance && *s.radiance != glm::vec3(0.0f)); });
  shines = shines ||
           (sees_media(scene.integrator) && std::ranges::any_of(scene.media, &ParticipatingMedium::emits));
  return shines || std::ranges::any_of(scene.emitters, [](const Emitter& e) { return !is_black(e); });
}

/// Integrators whose image does not depend on lights.
bool needs_no_light(const IntegratorSettings& integrator) {
  return integrator.is<AmbientOcclusionIntegrator>() || integrator.is<ReflectionOcclusionIntegrator>() ||
         integrator.is<NormalsIntegrator>();
}

/// Shows a scene that moves at the time asked for, else at that of a still.
Expected<void> show_at(SceneDescription& scene, std::optional<double> time) {
  if (scene.motion == nullptr) return {};
  return set_time(scene, time.value_or(scene.motion->default_time));
}

/// Says at which time a scene that moves is shown if nobody chose it. A file whose shutter is open for a time
/// has chosen it.
void report_time(SceneDescription& scene, const ReadOptions& options) {
  if (scene.motion == nullptr || options.time || (!scene.camera.shutter && scene.motion->shutter > 0.0))
    return;
  scene.warnings.push_back(
      fmt::format("{}: warning: the scene moves; it is shown as at {} s (--frames renders its frames)",
                  scene.source, scene.time));
}

constexpr std::string_view kOnlySky = "the scene has no shapes; only its sky is seen",
                           kNoShapes = "the scene has no shapes; the image is black",
                           kNoLight = "nothing in the scene emits light; the image is black";

/// Warns about scenes whose image is black or nearly black, which is probably not intended, in place of such
/// warnings about another time. With ReadOptions::strict warnings are errors.
Expected<void> check_warnings(SceneDescription& scene, const ReadOptions& options) {
  const auto warning = [&](std::string_view message) {
    return fmt::format("{}: warning: {}", scene.source, message);
  };
  for (const std::string_view message : {kOnlySky, kNoShapes, kNoLight})
    std::erase(scene.warnings, warning(message));
  const bool light = has_light(scene);
  if (scene.shapes.empty() && scene.instances.empty())
    scene.warnings.push_back(
        warning(light && std::ranges::any_of(scene.emitters, is_sky) ? kOnlySky : kNoShapes));
  else if (!light && !needs_no_light(scene.integrator))
    scene.warnings.push_back(warning(kNoLight));
  if (!options.strict || scene.warnings.empty()) return {};
  return fail(
      fmt::format("{}\n{}: warnings count as errors here", fmt::join(scene.warnings, "\n"), scene.source));
}

/// Reads what another program makes of the file. Messages name places in that as in a folder of the file's
/// name.
Expected<SceneDescription> read_exported(const std::filesystem::path& file, const ReadOptions& options) {
  if (!options.export_scene || options.confine_to)
    return fail(
        fmt::format("{}: Blender has to export such files, which does not happen here", file.string()));
  const auto exported = options.export_scene(file);
  if (!exported) return fail(fmt::format("{}: {}", file.string(), exported.error().message));
  const std::string folder = exported->file.parent_path().string();
  const auto in_file = [&](std::string text) {
    for (std::size_t at = text.find(folder); at != text.npos;
         at = text.find(folder, at + file.string().size()))
      text.replace(at, folder.size(), file.string());
    return text;
  };
  ReadOptions of_export = options;
  of_export.strict = false;
  of_export.export_options.clear();
  // The frame has been chosen already.
  of_export.time.reset();
  of_export.variables.clear();
  if (!of_export.fps) of_export.fps = exported->fps;
  auto scene = read_scene(exported->file, of_export);
  if (!scene) return fail(in_file(scene.error().message));
  for (std::string& warning : scene->warnings) warning = in_file(std::move(warning));
  std::vector<std::string> warnings;
  for (const std::string& what : exported->left_out)
    warnings.push_back(fmt::format("{}: warning: {}", file.string(), what));
  scene->warnings.insert(scene->warnings.begin(), warnings.begin(), warnings.end());
  std::erase_if(scene->files, [&](const auto& each) { return each.string().starts_with(folder); });
  scene->files.insert(scene->files.begin(), file);
  scene->source = file.string();
  scene->fps = exported->fps;
  scene->uses_variables = options.time.has_value();
  return scene;
}

}  // namespace

std::vector<std::string> scene_formats() {
  std::vector<std::string> names;
  for (const Format& each : formats()) names.push_back(fmt::format("{} ({})", each.name, each.extension));
  return names;
}

bool is_exported_scene(const std::filesystem::path& file) {
  const Format* format = format_of(file);
  return format != nullptr && format->is_exported;
}

Expected<void> check_scene_file(const std::filesystem::path& file, const ReadOptions& options) {
  const FileAccess files(options.confine_to);
  std::error_code ignored;
  if (files.allows(file) && std::filesystem::is_regular_file(file, ignored)) return {};
  const auto source = files.read(file, kMaxSceneFileBytes);
  return std::unexpected(source ? Error{fmt::format("cannot read '{}'", file.string())} : source.error());
}

namespace {

/// The file's format, which the options suit.
Expected<const Format*> suited_format(const std::filesystem::path& file, const ReadOptions& options) {
  // Check this first, before any message about the format.
  if (const auto found = check_scene_file(file, options); !found) return std::unexpected(found.error());
  const Format* format = format_of(file);
  if (format == nullptr) {
    return fail(fmt::format("{}: not a scene in a format that Penumbra reads; it reads: {}", file.string(),
                            list_names(scene_formats())));
  }
  if (!options.dialect.empty() && !format->has_dialects)
    return fail(fmt::format("{}: --dialect {} is of Nori's scenes; this one is {}", file.string(),
                            options.dialect, format->name));
  if (!options.clip.empty() && !format->has_clips)
    return fail(fmt::format("{}: --clip {} is of glTF files; this one is {}", file.string(), options.clip,
                            format->name));
  if (!options.export_options.empty() && !format->is_exported)
    return fail(fmt::format("{}: {} is of Blender's files; this one is {}", file.string(),
                            options.export_options, format->name));
  return format;
}

}  // namespace

Expected<SceneDescription> read_scene_file(const std::filesystem::path& file, const ReadOptions& options) {
  const auto format = suited_format(file, options);
  if (!format) return std::unexpected(format.error());
  if ((*format)->is_exported) return fail(fmt::format("{}: it is exported when it is read", file.string()));
  return (*format)->read(file, options);
}

Expected<void> complete_scene(SceneDescription& scene, const ReadOptions& options) {
  scene.frame_duration = 1.0 / options.fps.value_or(kFramesPerSecond);
  auto done = show_at(scene, options.time);
  if (done) done = apply_all(scene, options);
  if (!done) return fail(fmt::format("{}: {}", scene.source, done.error().message));
  report_time(scene, options);
  return check_warnings(scene, options);
}

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  const auto format = suited_format(file, options);
  if (!format) return std::unexpected(format.error());
  const bool is_exported = (*format)->is_exported;
  auto scene = is_exported ? read_exported(file, options) : (*format)->read(file, options);
  if (!scene) return scene;
  // What another program exported is complete.
  auto done = is_exported ? check_warnings(*scene, options) : complete_scene(*scene, options);
  if (!done) return std::unexpected(done.error());
  return scene;
}

Expected<void> set_time(SceneDescription& scene, double time, const ReadOptions& options) {
  auto done = set_time(scene, time);
  // Keys of the camera have replaced what settings say.
  if (done) done = apply_all(scene, options, "camera.");
  if (!done) return fail(fmt::format("{}: {}", scene.source, done.error().message));
  return check_warnings(scene, options);
}

}  // namespace penumbra
