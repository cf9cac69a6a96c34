#include "scenes/mitsuba/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/mitsuba/animation.h"
#include "scenes/mitsuba/emitter_reader.h"
#include "scenes/mitsuba/integrator_reader.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/medium_reader.h"
#include "scenes/mitsuba/sensor_reader.h"
#include "scenes/mitsuba/shape_reader.h"
#include "scenes/mitsuba/texture_reader.h"
#include "scenes/mitsuba/volume_reader.h"

namespace penumbra::mitsuba {
SceneDescription build_scene(const Context& plain, const FileAccess& files) {
  SceneDescription scene;
  Context context = plain;
  TextureReader textures(context, files);
  context.textures = &textures;
  context.files = &files;
  VolumeReader volumes;
  context.volumes = &volumes;
  scene.source = context.tree.scene.location.file->path.string();
  // Files of Mitsuba 3 say 3.0.0, whatever its version: the present one's rule, which is that from 3.7 on.
  if (context.tree.major_version >= 3) scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  PluginReader root(context, context.tree.scene);
  const Object* integrator = root.only_nested("integrator");
  const std::vector<const Object*> sensors = root.nested("sensor");
  const Object* sensor = sensors.empty() ? nullptr : sensors.front();
  if (sensors.size() > 1)
    root.warn(fmt::format("the scene has {} sensors; the first is rendered", sensors.size()));
  freeze_animations(context, sensor);
  if (integrator != nullptr) read_integrator(context, *integrator, scene);
  context.media_seen = scene.integrator.is<VolpathIntegrator>();
  MediumReader media(context);
  context.media = &media;
  if (sensor != nullptr) {
    read_sensor(context, *sensor, scene);
  } else {
    root.wrong("the scene has no <sensor>");
  }
  MaterialReader materials(context);
  for (const Object* bsdf : root.nested("bsdf")) materials.read(*bsdf);
  ShapeReader shapes(context, files, materials, scene);
  for (const Object* shape : root.nested("shape")) {
    if (context.diagnostics.full()) break;
    shapes.read(*shape);
  }
  bool all_known = true;
  SkyReader sky;
  for (const Object* light : root.nested("emitter"))
    all_known = read_emitter(context, *light, scene, sky) && all_known;
  // Light from everywhere, so that something can be seen: an unknown one may have been the scene's only
  // light.
  if (!all_known && std::ranges::none_of(scene.emitters, is_sky))
    scene.emitters.emplace_back(ConstantEnvironment{kStandInColour});
  for (const Object* texture : root.nested("texture")) textures.read(*texture);
  // They count where others refer to them.
  for (const char* tag : {"film", "sampler", "rfilter", "volume", "phase"}) root.nested(tag);
  for (const Object* medium : root.nested("medium")) media.read(*medium);
  root.finish();
  textures.install(scene);
  if (!context.diagnostics.failed()) shapes.check_textures();
  return scene;
}

}  // namespace penumbra::mitsuba
