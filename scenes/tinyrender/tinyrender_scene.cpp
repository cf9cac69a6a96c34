#include "scenes/tinyrender/tinyrender_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/settings.h"
#include "scenes/tinyrender/camera_reader.h"
#include "scenes/tinyrender/model_reader.h"
#include "scenes/tinyrender/renderer_reader.h"

namespace penumbra::tinyrender {
namespace {

void check_top_level(const Context& context, const ReadOptions& options) {
  const std::vector<std::string> known = {"input", "camera", "film", "renderer"};
  const auto unknown = [&](const std::string& name, SourceLocation location, std::string_view what) {
    const std::string hint = suggestion(name, known);
    context.unknown(location,
                    fmt::format("a TinyRender scene has no {} '{}'{} It has the tables: {}", what, name,
                                hint.empty() ? "." : hint, list_names(known)),
                    "it is left out");
  };
  for (const Table& table : context.document.tables) {
    if (std::ranges::find(known, table.name) == known.end()) unknown(table.name, table.location, "table");
  }
  for (const Entry& entry : context.document.entries) unknown(entry.key, entry.key_location, "key");
  for (const auto& [name, value] : options.defines)
    context.diagnostics.error({}, fmt::format("-D {}={}: a TinyRender scene has no variables", name, value));
}

}  // namespace

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  const FileAccess files(options.confine_to);
  const auto source = files.read(file, kMaxSceneFileBytes);
  if (!source) return std::unexpected(source.error());
  Diagnostics diagnostics;
  const Document document = parse_toml(**source, diagnostics);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  const Context context{**source, document, diagnostics, options.lenient};
  SceneDescription scene;
  scene.source = file.string();
  check_top_level(context, options);
  read_camera(context, scene);
  read_film(context, scene);
  read_renderer(context, scene);
  read_model(context, files, scene);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  if (options.settings.empty()) {  // else they may put it right
    if (const auto checked = check_settings(scene); !checked) {
      diagnostics.error({source->get(), 0}, checked.error().message);
      return std::unexpected(diagnostics.error());
    }
  }
  scene.contents_hash = files.contents_hash();
  scene.warnings = diagnostics.take_warnings();
  scene.files = files.files_read();
  return scene;
}

}  // namespace penumbra::tinyrender
