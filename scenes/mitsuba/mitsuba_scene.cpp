#include "scenes/mitsuba/mitsuba_scene.h"

#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_reader.h"
#include "scenes/reading.h"

namespace penumbra::mitsuba {

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  ObjectTree tree = read_object_tree(file, options, reading.files, reading.diagnostics);
  // An incomplete tree would only cause misleading errors.
  if (reading.failed()) return reading.error();
  const Context context{tree, reading.diagnostics, options.lenient, options.settings};
  SceneDescription scene = build_scene(context, reading.files);
  scene.uses_variables = tree.uses_variables;
  return reading.finish(std::move(scene), tree.scene.location);
}

}  // namespace penumbra::mitsuba
