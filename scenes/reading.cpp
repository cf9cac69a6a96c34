#include "scenes/reading.h"

#include <fmt/format.h>

#include <utility>

#include "scenes/settings.h"

namespace penumbra {

void Reading::refuse_variables(std::string_view format) {
  for (const auto& [name, value] : options.defines)
    diagnostics.error(
        {}, fmt::format("-D {}: a {} scene has no variables; those of Mitsuba have, as ${}. {}", name, format,
                        name,
                        name == "frame" ? "--frames renders its frames, also where "
                                          "each is a file: shot.####.pbrt"
                                        : "--set KEY=VALUE overrides settings (`penumbra settings`)"));
}

Expected<SceneDescription> Reading::finish(SceneDescription scene, SourceLocation root) {
  if (!failed() && root.file != nullptr && options.settings.empty())
    if (const auto checked = check_settings(scene); !checked)
      diagnostics.error(root, checked.error().message);
  for (const std::string& remark : files.remarks()) diagnostics.warn(root, remark);
  if (failed()) return error();
  scene.contents_hash = files.contents_hash();
  scene.warnings = diagnostics.take_warnings();
  scene.files = files.files_read();
  return scene;
}

}  // namespace penumbra
