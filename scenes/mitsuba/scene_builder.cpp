#include "scenes/mitsuba/scene_builder.h"

#include <fmt/format.h>

#include <cmath>

#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/sensor_reader.h"
#include "scenes/mitsuba/shape_reader.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

void read_point_light(PluginReader& plugin, SceneDescription& scene) {
  PointLight light;
  const auto position = plugin.point("position");
  const glm::dmat4 to_world = plugin.transform("to_world");
  if (position && plugin.has("to_world")) plugin.wrong("position", "either position or to_world, not both");
  light.position = position.value_or(transform_point(to_world, glm::dvec3(0.0)));
  light.intensity = plugin.colour("intensity", light.intensity, ColourRole::kEmission);
  plugin.accept({"sampling_weight"});
  scene.point_lights.push_back(light);
}

void read_environment(PluginReader& plugin, SceneDescription& scene) {
  if (scene.environment) plugin.wrong("there is a second constant emitter; a scene has one");
  scene.environment = ConstantEnvironment{plugin.colour("radiance", glm::vec3(1.0f), ColourRole::kEmission)};
  plugin.transform("to_world");  // which a constant does not see
  plugin.accept({"sampling_weight"});
}

/// False for one that needs a stand-in.
bool read_light(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  if (object.type == "point") {
    read_point_light(plugin, scene);
  } else if (object.type == "constant") {
    read_environment(plugin, scene);
  } else if (object.type == "area") {
    // It shines only from the shapes that refer to it.
    Shape nowhere;
    read_area_light(context, object, nowhere);
    plugin.skip();
  } else {
    const std::vector<std::string> known = {"area", "point", "constant"};
    context.unknown_plugin(object, known, "a constant magenta light stands in for it");
    plugin.skip();
    plugin.finish();
    return false;
  }
  plugin.finish();
  return true;
}

}  // namespace

SceneDescription build_scene(const Context& context, const FileAccess& files) {
  SceneDescription scene;
  scene.source = context.tree.scene.location.file->path.string();
  // Files of Mitsuba 3 say 3.0.0, whatever its version: the present one's rule, which is that from 3.7 on.
  if (context.tree.major_version >= 3) scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  PluginReader root(context, context.tree.scene);
  const Object* integrator = root.only_nested("integrator");
  const Object* sensor = root.only_nested("sensor");
  if (integrator != nullptr) read_integrator(context, *integrator, scene);
  if (sensor != nullptr) {
    read_sensor(context, *sensor, scene);
  } else {
    root.wrong("the scene has no <sensor>");
  }
  MaterialReader materials(context);
  for (const Object* bsdf : root.nested("bsdf")) materials.read(*bsdf);
  for (const Object* shape : root.nested("shape")) {
    if (context.diagnostics.full()) break;
    read_shape(context, *shape, files, materials, scene);
  }
  bool all_known = true;
  for (const Object* light : root.nested("emitter"))
    all_known = read_light(context, *light, scene) && all_known;
  // Light from everywhere, so that something can be seen: an unknown one may have been the scene's only
  // light.
  if (!all_known && !scene.environment) scene.environment = ConstantEnvironment{kStandInColour};
  for (const char* tag : {"texture", "medium", "volume", "phase"}) {
    for (const Object* object : root.nested(tag)) context.unknown_plugin(*object, {}, "it is left out");
  }
  root.finish();
  return scene;
}

}  // namespace penumbra::mitsuba
