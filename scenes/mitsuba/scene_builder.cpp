#include "scenes/mitsuba/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "scenes/mitsuba/animation.h"
#include "scenes/mitsuba/emitter_reader.h"
#include "scenes/mitsuba/integrator_reader.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/medium_reader.h"
#include "scenes/mitsuba/sensor_reader.h"
#include "scenes/mitsuba/shape_reader.h"
#include "scenes/mitsuba/texture_reader.h"
#include "scenes/mitsuba/volume_reader.h"
#include "scenes/names.h"
#include "scenes/scene_bounds.h"
#include "scenes/settings.h"

namespace penumbra::mitsuba {
namespace {

/// Replaces microfacet distributions of Mitsuba 0.x that version 3 lacks by the most similar one: Beckmann's
/// with the same alpha, whose mean slope corresponds to the exponent 2 / alpha² - 2 (Walter et al. 2007).
void replace_old_distributions(const Context& context) {
  for (Object& object : context.tree.objects)
    for (Parameter& parameter : object.parameters) {
      if (object.tag != "bsdf" || parameter.name != "distribution") continue;
      auto* const text = std::get_if<std::string>(&parameter.value);
      if (text == nullptr || (*text != "phong" && *text != "as")) continue;
      context.diagnostics.warn_counted(
          parameter.value_location,
          fmt::format("beckmann of the same alpha stands in for the distribution '{}'", *text));
      *text = parameter.text = "beckmann";
    }
}

/// Gives a scene without a sensor the one that Mitsuba 0.6 and the first versions of 3 make: it looks along
/// +z at the whole bounding box.
void place_sensor(const Context& context, SceneDescription& scene) {
  const auto placed = place_groups(scene);
  const SceneBounds bounds = bounds_of(scene, placed ? *placed : std::vector<PlacedGroup>());
  const SourceLocation location = context.tree.scene.location;
  for (const Object& object : context.tree.objects)
    if (object.tag == "sensor") {
      context.unsupported(object.location, "sensors of shapes are not read",
                          "one that sees all shapes takes its place");
      break;
    }
  const glm::dvec3 extents = bounds.high - bounds.low;
  const double largest = std::max({extents.x, extents.y, extents.z});
  if (!(largest > 0)) {
    context.unsupported(location, "the scene has no <sensor>, and no shapes that one could be placed before",
                        "a perspective one at the origin stands in for it");
    return;
  }
  context.diagnostics.warn(location, "the scene has no <sensor>; one that sees all shapes takes its place");
  CameraSettings& camera = scene.camera;
  camera.fov = 45;
  const double distance = 0.5 * largest / std::tan(0.5 * glm::radians(camera.fov));
  camera.to_world =
      glm::translate(glm::dmat4(1.0), {bounds.center().x, bounds.center().y, bounds.low.z - distance});
  camera.near_clip = distance / 100;
  camera.far_clip = 5 * largest + distance;
}

}  // namespace

SceneDescription build_scene(const Context& plain, const FileAccess& files) {
  SceneDescription scene;
  Context context = plain;
  TextureReader textures(context, files);
  context.textures = &textures;
  context.files = &files;
  VolumeReader volumes;
  context.volumes = &volumes;
  scene.source = context.tree.scene.location.file->path.string();
  // All files for Mitsuba 3 state version 3.0.0, so the rule of its current version is used, which is that
  // since 3.7.
  if (context.tree.major_version >= 3) scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  if (context.tree.major_version < 2) replace_old_distributions(context);
  PluginReader root(context, context.tree.scene);
  const Object* integrator = root.only_nested("integrator");
  const std::vector<const Object*> sensors = root.nested("sensor");
  const Object* sensor = sensors.empty() ? nullptr : sensors.front();
  if (sensors.size() > 1)
    root.warn(fmt::format("the scene has {} sensors; the first is rendered", sensors.size()));
  Animations animations(context, sensor);
  if (integrator != nullptr) read_integrator(context, *integrator, scene);
  for (const auto& [key, value] : context.settings)
    if (to_snake_case(key) == "integrator.type")
      static_cast<void>(apply_setting(scene, "integrator.type", value));
  context.media_seen = sees_media(scene.integrator);
  MediumReader media(context);
  context.media = &media;
  if (sensor != nullptr) {
    read_sensor(context, *sensor, animations.keys_of(*sensor), scene);
    animations.add_camera(*sensor, scene);
  }
  MaterialReader materials(context);
  for (const Object* bsdf : root.nested("bsdf")) materials.read(*bsdf);
  ShapeReader shapes(context, files, materials, animations, scene);
  for (const Object* shape : root.nested("shape")) {
    if (context.diagnostics.full()) break;
    shapes.read(*shape);
  }
  bool all_known = true;
  SkyReader sky;
  for (const Object* light : root.nested("emitter")) {
    const std::size_t first = scene.emitters.size();
    all_known = read_emitter(context, *light, scene, sky) && all_known;
    animations.add_emitters(*light, first, scene);
  }
  // Adds light from all directions, so that something is visible: an unknown emitter may have been the only
  // one.
  if (!all_known && std::ranges::none_of(scene.emitters, is_sky))
    scene.emitters.emplace_back(ConstantEnvironment{kPlaceholderColour});
  for (const Object* texture : root.nested("texture")) textures.read(*texture);
  // These objects are used only through references.
  for (const char* tag : {"film", "sampler", "rfilter", "volume", "phase"}) root.nested(tag);
  for (const Object* medium : root.nested("medium")) media.read(*medium);
  root.finish();
  textures.install(scene);
  if (sensor == nullptr) place_sensor(context, scene);
  shapes.add_motion();
  animations.install(scene);
  if (!context.diagnostics.failed()) shapes.check_textures();
  return scene;
}

}  // namespace penumbra::mitsuba
