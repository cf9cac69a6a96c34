#include "scenes/mitsuba/texture_reader.h"

#include <fmt/format.h>

#include <array>

namespace penumbra::mitsuba {
namespace {

template <typename Model>
TextureModel read_texture(PluginReader& plugin) {
  Model model;
  plugin.read_parameters(model);
  return model;
}

struct TexturePlugin {
  std::string_view type;
  TextureModel (*read)(PluginReader&);
};
template <typename... Models>
constexpr auto texture_plugins(const std::variant<Models...>*) {
  return std::array{TexturePlugin{Models::kPlugin, read_texture<Models>}...};
}
constexpr auto kTextures = texture_plugins(static_cast<const TextureModel*>(nullptr));

}  // namespace

std::optional<int> TextureReader::read(const Object& object) {
  if (const auto known = known_.find(&object); known != known_.end()) return known->second;
  if (!reading_.insert(&object).second) {
    context_.diagnostics.error(
        object.location, fmt::format("texture '{}' holds itself, through its references", name_of(object)));
    return std::nullopt;
  }
  std::optional<SceneTexture> texture = read_new(object);
  reading_.erase(&object);
  if (texture) textures_.push_back(std::move(*texture));
  return known_.emplace(&object, texture ? std::optional(int(textures_.size()) - 1) : std::nullopt)
      .first->second;
}

std::optional<SceneTexture> TextureReader::read_new(const Object& object) {
  PluginReader plugin(context_, object);
  const auto* known = find_plugin(kTextures, object.type);
  if (known == nullptr) {
    context_.unknown_plugin(object, plugin_types(kTextures), "a magenta checkerboard stands in for it");
    plugin.skip();
    if (!context_.lenient) return std::nullopt;
    CheckerboardTexture stand_in;
    stand_in.color0 = kStandInColour;
    return SceneTexture{name_of(object), stand_in};
  }
  SceneTexture texture{name_of(object), known->read(plugin)};
  const glm::dmat4 m = plugin.transform("to_uv");
  texture.to_uv =
      glm::dmat3(glm::dvec3(m[0].x, m[0].y, 0), glm::dvec3(m[1].x, m[1].y, 0), glm::dvec3(m[3].x, m[3].y, 1));
  plugin.finish();
  return texture;
}

}  // namespace penumbra::mitsuba
