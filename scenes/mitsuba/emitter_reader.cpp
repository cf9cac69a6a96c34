#include "scenes/mitsuba/emitter_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

void read_point_light(PluginReader& plugin, SceneDescription& scene) {
  PointLight light;
  const auto position = plugin.point("position");
  const glm::dmat4 to_world = plugin.transform("to_world");
  if (position && plugin.has("to_world")) plugin.wrong("position", "either position or to_world, not both");
  light.position = position.value_or(transform_point(to_world, glm::dvec3(0.0)));
  plugin.read_colour("intensity", light.intensity, ColourRole::kEmission);
  plugin.accept({"sampling_weight"});
  scene.emitters.emplace_back(light);
}

void read_environment(PluginReader& plugin, SceneDescription& scene) {
  if (std::ranges::any_of(scene.emitters, is_sky))
    plugin.wrong("there is a second constant emitter; a scene has one");
  ConstantEnvironment environment;
  plugin.read_colour("radiance", environment.radiance, ColourRole::kEmission);
  scene.emitters.emplace_back(environment);
  plugin.transform("to_world");  // which a constant does not see
  plugin.accept({"sampling_weight"});
}

struct EmitterPlugin {
  std::string_view type;
  void (*read)(PluginReader&, SceneDescription&);
};
constexpr EmitterPlugin kEmitters[] = {{"point", read_point_light}, {"constant", read_environment}};
// One that belongs to shapes.
constexpr std::string_view kArea = "area";

}  // namespace

void read_area_light(const Context& context, const Object& emitter, Shape& shape) {
  PluginReader plugin(context, emitter);
  if (emitter.type != kArea) {
    const std::vector<std::string> known = {std::string(kArea)};
    if (find_plugin(kEmitters, emitter.type) != nullptr) {
      plugin.wrong(fmt::format("{} cannot belong to a shape; an area light can", plugin.title()));
    } else {
      context.unknown_plugin(emitter, known, "it is left out");
    }
    plugin.skip();
    return;
  }
  plugin.read_colour("radiance", shape.radiance.emplace(1.0f), ColourRole::kEmission);
  shape.two_sided_emission = plugin.boolean("two_sided", false);
  if (shape.two_sided_emission && std::holds_alternative<Sphere>(shape.geometry))
    plugin.wrong("two_sided", "a sphere emits to one side; flip_normals chooses the inside");
  const std::string name = plugin.text("sampling", "auto");
  if (const auto sampling = emitter_samplings().parse(name)) {
    shape.sampling = *sampling;
  } else {
    plugin.wrong("sampling", sampling.error().message);
  }
  plugin.accept({"sampling_weight"});
  plugin.finish();
}

bool read_emitter(const Context& context, const Object& object, SceneDescription& scene) {
  PluginReader plugin(context, object);
  const EmitterPlugin* known = find_plugin(kEmitters, object.type);
  if (known != nullptr) {
    known->read(plugin, scene);
  } else if (object.type == kArea) {
    // It shines only from the shapes that refer to it.
    Shape nowhere;
    read_area_light(context, object, nowhere);
    plugin.skip();
  } else {
    std::vector<std::string> types = {std::string(kArea)};
    std::ranges::copy(plugin_types(kEmitters), std::back_inserter(types));
    context.unknown_plugin(object, types, "a constant magenta light stands in for it");
    plugin.skip();
    plugin.finish();
    return false;
  }
  plugin.finish();
  return true;
}

}  // namespace penumbra::mitsuba
