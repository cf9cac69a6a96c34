#include "scenes/tinyrender/tinyrender_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/reading.h"
#include "scenes/tinyrender/model_reader.h"
#include "scenes/tinyrender/renderer_reader.h"
#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {
namespace {

void check_top_level(const Context& context) {
  const std::vector<std::string> known = {"input", "camera", "film", "renderer"};
  const auto unknown = [&](const std::string& name, SourceLocation location, std::string_view what) {
    context.unknown(location,
                    fmt::format("a TinyRender scene has no {} '{}'{}", what, name,
                                known_names(name, known, "It has the tables")),
                    "it is left out");
  };
  for (const Table& table : context.document.tables) {
    if (std::ranges::find(known, table.name) == known.end()) unknown(table.name, table.location, "table");
  }
  for (const Entry& entry : context.document.entries) unknown(entry.key, entry.key_location, "key");
}

/// Reads a perspective camera at `eye` that looks at `at`. `up` points into the upper half of the image.
/// `fov` is the vertical full angle of view in degrees.
void read_camera(const Context& context, SceneDescription& scene) {
  Section camera(context, "camera");
  for (const char* key : {"eye", "at", "fov"}) camera.require(key);
  const auto eye = camera.vector("eye"), at = camera.vector("at");
  const auto up = camera.has("up") ? camera.vector("up") : "0 1 0";
  camera.accept("up");
  if (eye && at && up) camera.imply(scene, "camera.lookat", fmt::format("{} {} {}", *eye, *at, *up), "at");
  camera.set(scene, "camera.fov", "fov");
  camera.imply(scene, "camera.fov_axis", "y");
  // TinyRender's camera has no clipping planes.
  camera.imply(scene, "camera.near_clip", "1e-6");
  camera.imply(scene, "camera.far_clip", "1e30");
  camera.finish();
}

/// Reads the image size. The filter is a box of one pixel.
void read_film(const Context& context, SceneDescription& scene) {
  Section film(context, "film");
  for (const char* key : {"width", "height"}) film.require(key);
  film.set(scene, "film.width", "width");
  film.set(scene, "film.height", "height");
  film.imply(scene, "film.rfilter", "box");
  film.finish();
}

}  // namespace

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  const auto source = reading.files.read(file, kMaxSceneFileBytes);
  if (!source) return std::unexpected(source.error());
  const Document document = read_document(**source, reading.diagnostics);
  if (reading.failed()) return reading.error();
  const Context context{**source, document, reading.diagnostics, options.lenient};
  SceneDescription scene;
  scene.source = file.string();
  check_top_level(context);
  reading.refuse_variables("TinyRender");
  read_camera(context, scene);
  read_film(context, scene);
  read_renderer(context, scene);
  read_model(context, reading.files, scene);
  return reading.finish(std::move(scene), {source->get(), 0});
}

}  // namespace penumbra::tinyrender
