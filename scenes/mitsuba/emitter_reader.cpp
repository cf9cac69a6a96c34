#include "scenes/mitsuba/emitter_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace penumbra::mitsuba {
namespace {

template <typename Model>
void read_light(PluginReader& plugin, SceneDescription& scene) {
  if (Model::kIsSky && std::ranges::any_of(scene.emitters, is_sky))
    plugin.wrong(fmt::format("{} is a second sky; a scene has one", plugin.title()));
  Model light;
  plugin.read_parameters(light);
  plugin.accept({"sampling_weight"});
  scene.emitters.emplace_back(std::move(light));
}

struct EmitterPlugin {
  std::string_view type;
  void (*read)(PluginReader&, SceneDescription&);
};
template <typename... Models>
constexpr auto emitter_plugins(const std::variant<Models...>*) {
  return std::array{EmitterPlugin{Models::kPlugin, read_light<Models>}...};
}
constexpr auto kEmitters = emitter_plugins(static_cast<const Emitter*>(nullptr));
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
