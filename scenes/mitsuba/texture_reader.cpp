#include "scenes/mitsuba/texture_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace penumbra::mitsuba {

struct TexturePlugins {
  struct Row {
    std::string_view type;
    std::optional<TextureModel> (*read)(TextureReader&, PluginReader&);
  };
  template <typename... Models>
  static constexpr auto rows(const std::variant<Models...>*) {
    return std::array{Row{Models::kPlugin, TextureReader::read_as<Models>}...};
  }
};

namespace {

/// Mitsuba 3's texture of a constant without colour conversion: a number or three channels.
constexpr std::string_view kRawConstant = "rawconstant";

constexpr auto kTextures = TexturePlugins::rows(static_cast<const TextureModel*>(nullptr));

/// As a checkerboard of equal squares.
std::optional<TextureModel> read_raw_constant(PluginReader& plugin) {
  const auto& parameters = plugin.object().parameters;
  const auto given = std::ranges::find(parameters, "value", &Parameter::name);
  glm::vec3 value(0.0f);
  if (given == parameters.end()) {
    plugin.wrong("a rawconstant needs a <float name=\"value\" …>, or a <vector>");
    return std::nullopt;
  }
  if (std::holds_alternative<glm::dvec3>(given->value))
    value = glm::vec3(plugin.point("value").value_or(glm::dvec3(0.0)));
  else
    value = glm::vec3(float(plugin.number("value", 0.0)));
  for (int c = 0; c < 3; ++c)
    if (!(value[c] >= 0.0f && std::isfinite(value[c]))) {
      plugin.wrong("value", fmt::format("value: a texture is 0 or more and finite, not {}", value[c]));
      return std::nullopt;
    }
  CheckerboardTexture model;
  model.color0 = model.color1 = value;
  return model;
}

/// Mitsuba 0.6 has separate parameters instead of `to_uv`.
glm::dmat3 read_to_uv(PluginReader& plugin) {
  const glm::dmat4 m = plugin.transform("to_uv");
  const glm::dmat3 to_uv(glm::dvec3(m[0].x, m[0].y, 0), glm::dvec3(m[1].x, m[1].y, 0),
                         glm::dvec3(m[3].x, m[3].y, 1));
  const double scale = plugin.number("uvscale", 1.0);
  const glm::dvec2 scales(plugin.number("uscale", scale), plugin.number("vscale", scale));
  const glm::dvec2 offsets(plugin.number("uoffset", 0.0), plugin.number("voffset", 0.0));
  return glm::dmat3(glm::dvec3(scales.x, 0, 0), glm::dvec3(0, scales.y, 0), glm::dvec3(offsets, 1)) * to_uv;
}

}  // namespace

std::optional<int> TextureReader::read(const Object& object, TextureUse use) {
  if (const auto known = known_.find({&object, use}); known != known_.end()) return known->second;
  if (!begin(object)) return std::nullopt;
  std::optional<SceneTexture> texture = read_new(object, use);
  reading_.erase(&object);
  if (texture) textures_.push_back(std::move(*texture));
  return known_
      .emplace(std::pair(&object, use), texture ? std::optional(int(textures_.size()) - 1) : std::nullopt)
      .first->second;
}

/// Whether it may be read: it must not be in the process of being read.
bool TextureReader::begin(const Object& object) {
  if (reading_.insert(&object).second) return true;
  context_.diagnostics.error(
      object.location, fmt::format("texture '{}' holds itself, through its references", name_of(object)));
  return false;
}

std::optional<SceneTexture> TextureReader::read_new(const Object& object, TextureUse use) {
  PluginReader plugin(context_, object);
  // Mitsuba 0.6's name for vertex colours.
  const bool vertex_colours = object.type == "vertexcolors";
  const auto* known = find_plugin(kTextures, vertex_colours ? MeshAttributeTexture::kPlugin : object.type);
  if (object.type == kRawConstant) {
    std::optional<TextureModel> model = read_raw_constant(plugin);
    plugin.finish();
    return model ? std::optional(SceneTexture{name_of(object), std::move(*model)}) : std::nullopt;
  }
  if (known == nullptr) {
    std::vector<std::string> types = plugin_types(kTextures);
    types.emplace_back(kRawConstant);
    context_.unknown_plugin(object, types, "a magenta checkerboard stands in for it");
    plugin.skip();
    if (!context_.lenient) return std::nullopt;
    CheckerboardTexture placeholder;
    placeholder.color0 = kPlaceholderColour;
    return SceneTexture{name_of(object), placeholder};
  }
  const glm::dmat3 to_uv = read_to_uv(plugin);
  const TextureUse outer = std::exchange(use_, use);
  std::optional<TextureModel> model = known->read(*this, plugin);
  use_ = outer;
  plugin.finish();
  if (!model) return std::nullopt;
  // Mitsuba 3 exchanges the colours of a checkerboard used as a number.
  if (auto* board = std::get_if<CheckerboardTexture>(&*model); board != nullptr && use == TextureUse::kNumber)
    std::swap(board->color0, board->color1);
  return SceneTexture{name_of(object), std::move(*model), to_uv};
}

std::optional<TextureModel> TextureReader::read_model(PluginReader& plugin, ScaleTexture model) {
  plugin.read_parameters(model);
  const Object* inside = plugin.only_nested("texture");
  if (inside == nullptr) {
    plugin.wrong("a scale texture holds the texture that it scales");
    return std::nullopt;
  }
  const std::optional<int> index = read(*inside, use_);
  model.texture = index.value_or(kNoTexture);
  return index ? std::optional<TextureModel>(model) : std::nullopt;
}

std::optional<TextureModel> TextureReader::read_model(PluginReader& plugin, BitmapTexture model) {
  plugin.read_parameters(model);
  // Parameters about storing and looking up texels.
  plugin.accept({"max_anisotropy", "cache", "format", "accel"});
  if (model.filename.empty()) return std::nullopt;
  const auto path = files_.find(model.filename, context_.folders(plugin.object()));
  if (!path) return without_bitmap(plugin, path.error().message);
  const auto entry = bitmaps_.read(*path, model.channel);
  if (!entry) return without_bitmap(plugin, entry.error().message);
  model.bitmap = entry->bitmap;
  report(plugin, model, entry->findings);
  return model;
}

std::optional<TextureModel> TextureReader::read_model(PluginReader& plugin, MeshAttributeTexture model) {
  // A mesh stores one attribute of each kind: the one chosen by mesh_attribute_names.h.
  const std::string name = plugin.text("name", "vertex_color");
  plugin.read("scale", model.scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber});
  model.attribute = name.starts_with("face_") ? MeshAttribute::kFaceColour : MeshAttribute::kVertexColour;
  if (!name.starts_with("face_") && !name.starts_with("vertex_")) {
    plugin.wrong("name",
                 fmt::format("name: '{}' is no attribute of a mesh: it begins with vertex_ or face_", name));
    return std::nullopt;
  }
  return model;
}

std::optional<TextureModel> TextureReader::without_bitmap(PluginReader& plugin, const std::string& message) {
  if (!context_.lenient) {
    plugin.wrong("filename", message);
    return std::nullopt;
  }
  plugin.warn(message + "; a magenta checkerboard stands in for it");
  CheckerboardTexture placeholder;
  placeholder.color0 = kPlaceholderColour;
  return placeholder;
}

void TextureReader::report(PluginReader& plugin, const BitmapTexture& model, const BitmapFindings& findings) {
  const Bitmap& bitmap = bitmaps_.bitmap(model.bitmap);
  for (const std::string& finding : describe(findings, bitmap.name, !model.raw)) plugin.warn(finding);
  const bool whole_numbers = bitmap.type == TexelType::kByte || bitmap.type == TexelType::kShort;
  if (!whole_numbers && plugin.has("gamma") && model.gamma != 1.0f)
    plugin.warn(fmt::format("'{}' holds linear numbers; gamma does nothing", bitmap.name));
}

std::shared_ptr<const Bitmap> TextureReader::read_image(PluginReader& plugin, const std::string& filename) {
  const auto fail_with = [&](const std::string& message) {
    context_.lenient ? plugin.warn(message) : plugin.wrong("filename", message);
    return nullptr;
  };
  const auto path = files_.find(filename, context_.folders(plugin.object()));
  if (!path) return fail_with(path.error().message);
  const auto entry = bitmaps_.read(*path, BitmapChannels::kAll);
  if (!entry) return fail_with(entry.error().message);
  const Bitmap& bitmap = bitmaps_.bitmap(entry->bitmap);
  for (const std::string& finding : describe(entry->findings, bitmap.name, false)) plugin.warn(finding);
  return bitmaps_.shared(entry->bitmap);
}

TextureImage TextureReader::read_texture_image(const Object& object) {
  PluginReader plugin(context_, object);
  read_to_uv(plugin);
  TextureImage image;
  if (object.type == BitmapTexture::kPlugin) {
    const std::optional<TextureModel> model = read_model(plugin, BitmapTexture{});
    if (const auto* bitmap = model ? std::get_if<BitmapTexture>(&*model) : nullptr)
      image = {bitmaps_.shared(bitmap->bitmap), bitmap->gamma};
  } else if (object.type == ScaleTexture::kPlugin) {
    ScaleTexture model;
    plugin.read_parameters(model);
    const Object* inside = plugin.only_nested("texture");
    const glm::vec3 scale = model.scale.value;
    if (scale != glm::vec3(scale.x)) plugin.wrong("scale", "heights are scaled by a number, not by a colour");
    if (inside == nullptr) plugin.wrong("a scale texture holds the texture that it scales");
    if (inside != nullptr && begin(object)) {
      image = read_texture_image(*inside);
      image.scale *= scale.x;
      reading_.erase(&object);
    }
  } else {
    plugin.wrong(fmt::format("'{}' has no texels of its own; a bitmap has, or one in a scale", object.type));
    plugin.skip();
  }
  plugin.finish();
  return image;
}

void TextureReader::install(SceneDescription& scene) {
  scene.textures = std::move(textures_);
  scene.bitmaps = bitmaps_.take();
}

}  // namespace penumbra::mitsuba
