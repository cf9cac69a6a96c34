#include "scenes/tinyrender/tinyrender_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/reading.h"
#include "scenes/tinyrender/camera_reader.h"
#include "scenes/tinyrender/model_reader.h"
#include "scenes/tinyrender/renderer_reader.h"

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
