#include "scenes/mitsuba/emitter_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/mitsuba/animation.h"
#include "scenes/sky/sky_parameters.h"
#include "scenes/sky/timed_sky.h"

namespace penumbra::mitsuba {
namespace {

/// The destination of lights.
struct Lights {
  SceneDescription& scene;
  SkyReader& sky;
  const Context& context;
};

template <typename Model>
Model read_emitter_parameters(PluginReader& plugin) {
  Model light;
  plugin.read_parameters(light);
  plugin.accept({"sampling_weight"});
  return light;
}

/// Reads the parameters of an emitter. A second sky is an error.
template <typename Model>
Model read_one_emitter(PluginReader& plugin, const SceneDescription& scene) {
  if (Model::kIsSky && std::ranges::any_of(scene.emitters, is_sky))
    plugin.wrong(fmt::format("{} is a second sky; a scene has one", plugin.title()));
  return read_emitter_parameters<Model>(plugin);
}

template <typename Model>
void read_light(PluginReader& plugin, Lights& lights) {
  lights.scene.emitters.emplace_back(read_one_emitter<Model>(plugin, lights.scene));
}

template <>
void read_light<EnvironmentMapLight>(PluginReader& plugin, Lights& lights) {
  SceneDescription& scene = lights.scene;
  auto light = read_one_emitter<EnvironmentMapLight>(plugin, scene);
  plugin.accept({"mis_compensation", "cache"});
  if (light.filename.empty())
    return plugin.wrong(fmt::format("{} needs a <string name=\"filename\" …>", plugin.title()));
  light.image = plugin.read_image(light.filename);
  if (light.image == nullptr) {
    scene.emitters.emplace_back(ConstantEnvironment{kPlaceholderColour});
    return;
  }
  if (light.image->width < 2 || light.image->height < 2 || light.image->width > (1 << 15) ||
      light.image->height > (1 << 15))
    return plugin.wrong("filename",
                        fmt::format("an environment map has 2 x 2 to 32768 x 32768 texels, not {} x {}",
                                    light.image->width, light.image->height));
  scene.emitters.emplace_back(std::move(light));
}

/// Reads a sky that becomes an environment map.
template <typename Sky>
void read_sky(PluginReader& plugin, Lights& lights) {
  const auto sky = read_emitter_parameters<Sky>(plugin);
  lights.sky.add(plugin, sky, Sky::kIs, lights.scene);
}

/// The sky while the first sensor's shutter is open.
void read_timed_sky(PluginReader& plugin, Lights& lights) {
  const auto sky = read_one_emitter<TimedSkyEmitter>(plugin, lights.scene);
  if (lights.context.diagnostics.failed()) return;
  const Shutter shutter = shutter_of(lights.context);
  EnvironmentMapLight light = sky.emitter(shutter.open, shutter.close);
  if (!(shutter.close > shutter.open))
    plugin.warn(
        fmt::format("the sensor's shutter_open is its shutter_close, so the sky is that of one instant, "
                    "at time {}; shutters from {} to {} give the mean of all hours",
                    shutter.open, sky.shutter_open, sky.shutter_close));
  if (!is_black(Emitter(light))) lights.scene.emitters.emplace_back(std::move(light));
}

struct EmitterPlugin {
  std::string_view type;
  void (*read)(PluginReader&, Lights&);
};
template <typename... Models>
constexpr auto emitter_plugins(const std::variant<Models...>*) {
  return std::array{EmitterPlugin{Models::kPlugin, read_light<Models>}...};
}
template <typename... Skies>
constexpr auto sky_plugins(const std::variant<Skies...>*) {
  return std::array{EmitterPlugin{Skies::kPlugin, read_sky<Skies>}...};
}
template <std::size_t N, std::size_t M>
constexpr auto both(const std::array<EmitterPlugin, N>& first, const std::array<EmitterPlugin, M>& second) {
  std::array<EmitterPlugin, N + M> all{};
  std::ranges::copy(first, all.begin());
  std::ranges::copy(second, all.begin() + N);
  return all;
}
constexpr auto kEmitters = both(both(emitter_plugins(static_cast<const Emitter*>(nullptr)),
                                     sky_plugins(static_cast<const SkyModels*>(nullptr))),
                                std::array{EmitterPlugin{TimedSkyEmitter::kPlugin, read_timed_sky}});
/// Accepts a medium around the emitter. It is not needed, because paths that start at the camera know their
/// medium.
void accept_medium(PluginReader& plugin) { plugin.nested("medium"); }

// The emitter that belongs to shapes.
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
  AreaLightParameters light;
  plugin.read_parameters(light);
  shape.radiance = light.radiance.value;
  shape.radiance_texture = light.radiance.texture;
  shape.two_sided_emission = light.two_sided;
  shape.camera_sees_emission = light.seen_by_camera;
  shape.emission_spread = light.spread;
  shape.sampling = light.sampling;
  const char* round = std::holds_alternative<Sphere>(shape.geometry)     ? "sphere"
                      : std::holds_alternative<Cylinder>(shape.geometry) ? "cylinder"
                                                                         : nullptr;
  if (shape.two_sided_emission && round != nullptr)
    plugin.wrong("two_sided", fmt::format("a {} emits to one side; flip_normals chooses the inside", round));
  if (!(light.spread >= 0.1 && light.spread <= 180.0))
    plugin.wrong("spread", fmt::format("spread must be a number in [0.1, 180], not {}", light.spread));
  else if (shape.has_spread() && (round != nullptr || std::holds_alternative<Curves>(shape.geometry)))
    plugin.wrong("spread", "only a flat shape, a mesh or a disk, has a spread below 180");
  plugin.accept({"sampling_weight"});
  accept_medium(plugin);
  plugin.finish();
}

bool read_emitter(const Context& context, const Object& object, SceneDescription& scene, SkyReader& sky) {
  PluginReader plugin(context, object);
  const EmitterPlugin* known = find_plugin(kEmitters, object.type);
  if (known != nullptr) {
    Lights lights{scene, sky, context};
    known->read(plugin, lights);
    accept_medium(plugin);
  } else if (object.type == kArea) {
    // Its light comes only from the shapes that refer to it.
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
