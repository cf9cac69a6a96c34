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
  return reading.finish(build_scene(context, reading.files), tree.scene.location);
}

}  // namespace penumbra::mitsuba
