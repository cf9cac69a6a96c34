#include "scenes/mitsuba/mitsuba_scene.h"

#include "scenes/file_access.h"
#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_reader.h"
#include "scenes/settings.h"

namespace penumbra::mitsuba {

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  const FileAccess files(options.confine_to);
  Diagnostics diagnostics;
  ObjectTree tree = read_object_tree(file, options, files, diagnostics);
  // A tree with holes would only give rise to misleading errors.
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  const Context context{tree, diagnostics, options.lenient};
  SceneDescription scene = build_scene(context, files);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  if (options.settings.empty()) {  // else they may put it right
    if (const auto checked = check_settings(scene); !checked) {
      diagnostics.error(tree.scene.location, checked.error().message);
      return std::unexpected(diagnostics.error());
    }
  }
  scene.contents_hash = files.contents_hash();
  scene.warnings = diagnostics.take_warnings();
  scene.files = files.files_read();
  return scene;
}

}  // namespace penumbra::mitsuba
