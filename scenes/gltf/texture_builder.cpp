#include "scenes/gltf/texture_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "scenes/gltf/data_address.h"
#include "scenes/image/bitmap_values.h"

namespace penumbra::gltf {
namespace {

int wrap_of(int gltf) {
  return gltf == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? WRAP_CLAMP
         : gltf == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? WRAP_MIRROR
                                                         : WRAP_REPEAT;
}

glm::dvec2 pair_of(const tinygltf::Value& value, const char* name, glm::dvec2 fallback) {
  if (!value.Has(name)) return fallback;
  const tinygltf::Value& pair = value.Get(name);
  if (!pair.IsArray() || pair.ArrayLen() != 2) return fallback;
  return {pair.Get(0).GetNumberAsDouble(), pair.Get(1).GetNumberAsDouble()};
}

/// The file extension for a media type.
const char* ending_of(std::string_view media_type) {
  constexpr std::pair<std::string_view, const char*> kEndings[] = {{"image/jpeg", ".jpg"},
                                                                   {"image/jpg", ".jpg"},
                                                                   {"image/webp", ".webp"},
                                                                   {"image/avif", ".avif"},
                                                                   {"image/vnd-ms.dds", ".dds"}};
  for (const auto& [type, ending] : kEndings)
    if (type == media_type) return ending;
  return ".png";
}

/// A bitmap of bytes, whose values represent 0 to 1.
Bitmap byte_bitmap(const std::string& name, int width, int height, int channels,
                   const std::vector<std::uint8_t>& values) {
  Bitmap bitmap{
      name, width, height, channels, TexelType::kByte, std::vector<std::uint32_t>((values.size() + 3) / 4)};
  for (std::size_t i = 0; i < values.size(); ++i)
    bitmap.words[i / 4] |= std::uint32_t(values[i]) << (i % 4 * 8);
  return bitmap;
}

std::uint8_t to_byte(double value) { return std::uint8_t(std::lround(255.0 * std::clamp(value, 0.0, 1.0))); }

/// A normal map with its vectors multiplied by `scale`, and normalised.
Bitmap scaled_normals(const Bitmap& map, const glm::dvec3& scale) {
  const std::size_t texels = std::size_t(map.width) * std::size_t(map.height);
  const auto channels = std::size_t(map.channels);
  std::vector<float> values;
  values.reserve(3 * texels);
  for (std::size_t i = 0; i < texels; ++i) {
    glm::dvec3 n;
    for (std::size_t c = 0; c < 3; ++c)
      n[int(c)] = 2.0 * bitmap_value(map, i * channels + std::min(c, channels - 1), 1.0f) - 1.0;
    n *= scale;
    const double length = glm::length(n);
    n = length > 0.0 ? n / length : glm::dvec3(0.0, 0.0, 1.0);
    for (int c = 0; c < 3; ++c) values.push_back(float(0.5 * n[c] + 0.5));
  }
  return float_bitmap(map.name, map.width, map.height, 3, values);
}

}  // namespace

glm::dmat3 texture_transform(glm::dvec2 offset, double rotation, glm::dvec2 scale) {
  const double c = std::cos(rotation), s = std::sin(rotation);
  return glm::dmat3(glm::dvec3(c * scale.x, -s * scale.x, 0), glm::dvec3(s * scale.y, c * scale.y, 0),
                    glm::dvec3(offset, 1));
}

TextureUse texture_use(int index, int texcoord, const tinygltf::ExtensionMap& extensions,
                       SourceLocation location) {
  TextureUse use{index, texcoord, glm::dmat3(1.0), location};
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end()) return use;
  const tinygltf::Value& transform = found->second;
  const double rotation = transform.Has("rotation") ? transform.Get("rotation").GetNumberAsDouble() : 0.0;
  use.to_uv = texture_transform(pair_of(transform, "offset", glm::dvec2(0.0)), rotation,
                                pair_of(transform, "scale", glm::dvec2(1.0)));
  if (transform.Has("texCoord")) use.texcoord = transform.Get("texCoord").GetNumberAsInt();
  return use;
}

int TextureBuilder::source_of(const TextureUse& use) const {
  const tinygltf::Texture& texture = asset_.model.textures[std::size_t(use.index)];
  if (texture.source >= 0) return texture.source;
  for (const char* name : {"EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
    const auto extension = texture.extensions.find(name);
    if (extension != texture.extensions.end() && extension->second.Has("source"))
      return extension->second.Get("source").GetNumberAsInt();
  }
  return -1;
}

std::string TextureBuilder::name_of(const TextureUse& use) const {
  const int source = source_of(use);
  const tinygltf::Image& image = asset_.model.images[std::size_t(source)];
  if (!image.uri.empty() && !is_data_address(image.uri)) {
    const auto file = find_file(asset_, image.uri);
    return (file ? *file : asset_.json->path.parent_path() / image.uri).string();
  }
  // The extension tells readers the format if the contents do not.
  return fmt::format("{}: image {}{}{}", asset_.json->path.filename().string(), source,
                     image.name.empty() ? "" : " " + image.name, ending_of(image.mimeType));
}

std::optional<int> TextureBuilder::bitmap(const TextureUse& use, BitmapChannels channels) {
  const auto& textures = asset_.model.textures;
  const auto without = [&](const std::string& message) -> std::optional<int> {
    report_.unsupported(use.location, message, "it is left out");
    return std::nullopt;
  };
  if (std::size_t(use.index) >= textures.size())
    return without(fmt::format("there is no texture {}", use.index));
  const int source = source_of(use);
  if (source < 0 && textures[std::size_t(use.index)].extensions.contains("KHR_texture_basisu"))
    return without(
        fmt::format("texture {} has an image of KTX2 alone (KHR_texture_basisu), which is not read: convert "
                    "it to PNG, JPEG or WebP, with gltf-transform's ktxdecompress for example",
                    use.index));
  if (source < 0 && textures[std::size_t(use.index)].extensions.empty()) {  // as glTF allows
    report_.warn(use.location, fmt::format("texture {} has no image; it is left out", use.index));
    return std::nullopt;
  }
  if (source < 0 || std::size_t(source) >= asset_.model.images.size())
    return without(
        fmt::format("texture {} has no image that is read (PNG, JPEG, WebP and DDS are)", use.index));
  const auto contents = asset_.image(source);
  if (!contents) return without(contents.error().message);
  const auto entry = bitmaps_.read_contents(name_of(use), *contents, channels);
  if (!entry) {
    if (channels == BitmapChannels::kAlpha) return std::nullopt;  // usually an opaque image
    return without(entry.error().message);
  }
  return entry->bitmap;
}

int TextureBuilder::add(const TextureUse& use, int bitmap, float gamma, BitmapChannels channels) {
  BitmapTexture model;
  model.filename = name_of(use);
  model.bitmap = bitmap;
  model.gamma = gamma;
  model.raw = gamma == 1.0f;
  model.channel = channels;
  const int sampler = asset_.model.textures[std::size_t(use.index)].sampler;
  if (sampler >= 0 && std::size_t(sampler) < asset_.model.samplers.size()) {
    const tinygltf::Sampler& gltf = asset_.model.samplers[std::size_t(sampler)];
    model.wrap_u = wrap_of(gltf.wrapS);
    model.wrap_v = wrap_of(gltf.wrapT);
    if (gltf.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) model.filter = BitmapFilter::kNearest;
  }
  model.wrap = model.wrap_u;
  SceneTexture texture{model.filename, model, use.to_uv};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(texture.to_uv[i][j]) < 1e30)) {
        report_.error(use.location, "the texture's transform is not finite");
        texture.to_uv = glm::dmat3(1.0);
      }
  scene_.textures.push_back(std::move(texture));
  return int(scene_.textures.size()) - 1;
}

std::optional<int> TextureBuilder::colours(const TextureUse& use) {
  const auto index = bitmap(use, BitmapChannels::kAll);
  return index ? std::optional(add(use, *index, kSrgb, BitmapChannels::kAll)) : std::nullopt;
}

std::optional<int> TextureBuilder::channel(const TextureUse& use, BitmapChannels channel) {
  const auto index = bitmap(use, channel);
  return index ? std::optional(add(use, *index, 1.0f, channel)) : std::nullopt;
}

std::optional<int> TextureBuilder::alpha(const TextureUse& use) {
  return channel(use, BitmapChannels::kAlpha);
}

std::optional<int> TextureBuilder::cut_alpha(const TextureUse& use, double factor, double cutoff) {
  const auto index = bitmap(use, BitmapChannels::kAlpha);
  if (!index) return std::nullopt;
  const auto [known, is_new] = cut_bitmaps_.try_emplace({*index, factor, cutoff}, -1);
  if (is_new) {
    const Bitmap& alpha = bitmaps_.bitmap(*index);
    std::vector<float> cut(std::size_t(alpha.width) * std::size_t(alpha.height));
    for (std::size_t i = 0; i < cut.size(); ++i)
      cut[i] = bitmap_value(alpha, i, 1.0f) * factor >= cutoff ? 1.0f : 0.0f;
    known->second = bitmaps_.add(float_bitmap(alpha.name, alpha.width, alpha.height, 1, cut));
  }
  return add(use, known->second, 1.0f, BitmapChannels::kAlpha);
}

std::optional<int> TextureBuilder::vectors(const TextureUse& use) {
  const auto index = bitmap(use, BitmapChannels::kAll);
  return index ? std::optional(add(use, *index, 1.0f, BitmapChannels::kAll)) : std::nullopt;
}

std::optional<int> TextureBuilder::normals(const TextureUse& use, double scale, bool mirrored) {
  auto index = bitmap(use, BitmapChannels::kAll);
  if (!index) return std::nullopt;
  if (scale != 1.0 || mirrored) {
    const auto [known, is_new] = changed_normals_.try_emplace({*index, scale, mirrored}, -1);
    if (is_new)
      known->second = bitmaps_.add(
          scaled_normals(bitmaps_.bitmap(*index), glm::dvec3(scale, mirrored ? -scale : scale, 1.0)));
    index = known->second;
  }
  return add(use, *index, 1.0f, BitmapChannels::kAll);
}

int TextureBuilder::vertex_colours(int times) {
  MeshAttributeTexture colours;
  colours.times = times;
  scene_.textures.push_back({"COLOR_0", colours});
  return int(scene_.textures.size()) - 1;
}

std::optional<int> TextureBuilder::roughness_of(const TextureUse& glossiness, double factor) {
  const auto index = bitmap(glossiness, BitmapChannels::kAlpha);
  if (!index) return std::nullopt;
  const Bitmap& gloss = bitmaps_.bitmap(*index);
  std::vector<std::uint8_t> rough(std::size_t(gloss.width) * std::size_t(gloss.height));
  for (std::size_t i = 0; i < rough.size(); ++i)
    rough[i] = to_byte(1.0 - factor * bitmap_value(gloss, i, 1.0f));
  return add(glossiness, bitmaps_.add(byte_bitmap(gloss.name, gloss.width, gloss.height, 1, rough)), 1.0f,
             BitmapChannels::kAlpha);
}

int TextureBuilder::product(int texture, int by) {
  if (texture == kNoTexture) return by;
  // The last factor of the first texture.
  int* next = &texture;
  while (*next != kNoTexture)
    next = std::visit(
        [](auto& model) -> int* {
          if constexpr (requires { model.times; }) return &model.times;
          if constexpr (requires { model.texture; }) return &model.texture;
          return nullptr;  // glTF has no other textures
        },
        scene_.textures[std::size_t(*next)].model);
  *next = by;
  return texture;
}

int TextureBuilder::scaled(int texture, const glm::vec3& factor) {
  if (factor == glm::vec3(1.0f)) return texture;
  scene_.textures.push_back({scene_.textures[std::size_t(texture)].name, ScaleTexture{factor, texture}});
  return int(scene_.textures.size()) - 1;
}

}  // namespace penumbra::gltf
