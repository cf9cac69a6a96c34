#include "scenes/gltf/texture_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "scenes/gltf/data_address.h"
#include "scenes/gltf/specular_glossiness.h"
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

/// Encodes as sRGB (IEC 61966-2-1).
std::uint8_t to_srgb_byte(double value) {
  return to_byte(value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055);
}

/// Looks up a bitmap at the resolution of another one. Without a bitmap the value is 1 everywhere.
class Resampled {
 public:
  Resampled(const Bitmap* bitmap, float gamma) : bitmap_(bitmap) {
    if (bitmap != nullptr) values_.emplace(*bitmap, gamma);
  }
  [[nodiscard]] double at(std::size_t x, std::size_t y, std::size_t width, std::size_t height,
                          std::size_t channel) const {
    if (bitmap_ == nullptr) return 1.0;
    const auto w = std::size_t(bitmap_->width), h = std::size_t(bitmap_->height),
               n = std::size_t(bitmap_->channels);
    return double((*values_)[(y * h / height * w + x * w / width) * n + std::min(channel, n - 1)]);
  }

 private:
  const Bitmap* bitmap_;
  std::optional<BitmapValues> values_{};
};

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

std::optional<int> TextureBuilder::normals(const TextureUse& use, double scale) {
  auto index = bitmap(use, BitmapChannels::kAll);
  if (!index) return std::nullopt;
  if (scale != 1.0) {
    const auto [known, is_new] = scaled_normals_.try_emplace({*index, scale}, -1);
    if (is_new) {
      const Bitmap& map = bitmaps_.bitmap(*index);
      const std::size_t texels = std::size_t(map.width) * std::size_t(map.height);
      const auto channels = std::size_t(map.channels);
      std::vector<float> values;
      values.reserve(3 * texels);
      for (std::size_t i = 0; i < texels; ++i) {
        glm::dvec3 n;
        for (std::size_t c = 0; c < 3; ++c)
          n[int(c)] = 2.0 * bitmap_value(map, i * channels + std::min(c, channels - 1), 1.0f) - 1.0;
        n = glm::dvec3(scale * n.x, scale * n.y, n.z);
        const double length = glm::length(n);
        n = length > 0.0 ? n / length : glm::dvec3(0.0, 0.0, 1.0);
        for (int c = 0; c < 3; ++c) values.push_back(float(0.5 * n[c] + 0.5));
      }
      known->second = bitmaps_.add(float_bitmap(map.name, map.width, map.height, 3, values));
    }
    index = known->second;
  }
  return add(use, *index, 1.0f, BitmapChannels::kAll);
}

std::optional<TextureBuilder::Converted> TextureBuilder::specular_glossiness(
    const TextureUse& diffuse, const TextureUse& specular, const glm::dvec3& diffuse_factor,
    const glm::dvec3& specular_factor, double glossiness) {
  const auto read = [&](const TextureUse& use, BitmapChannels channels) {
    return use.there() ? bitmap(use, channels) : std::nullopt;
  };
  const auto of_diffuse = read(diffuse, BitmapChannels::kAll),
             of_specular = read(specular, BitmapChannels::kAll);
  if (!of_diffuse && !of_specular) return std::nullopt;
  const auto of_gloss = of_specular ? read(specular, BitmapChannels::kAlpha) : std::nullopt;
  const auto of = [&](const std::optional<int>& index) { return index ? &bitmaps_.bitmap(*index) : nullptr; };
  int width = 1, height = 1;
  for (const Bitmap* map : {of(of_diffuse), of(of_specular)})
    if (map != nullptr) width = std::max(width, map->width), height = std::max(height, map->height);
  const Resampled diffuse_map(of(of_diffuse), kSrgb), specular_map(of(of_specular), kSrgb),
      gloss_map(of(of_gloss), 1.0f);
  std::vector<std::uint8_t> colours, metallic, roughness;
  const auto w = std::size_t(width), h = std::size_t(height);
  for (std::size_t y = 0; y < h; ++y)
    for (std::size_t x = 0; x < w; ++x) {
      glm::dvec3 d, s;
      for (int c = 0; c < 3; ++c) {
        d[c] = diffuse_factor[c] * diffuse_map.at(x, y, w, h, std::size_t(c));
        s[c] = specular_factor[c] * specular_map.at(x, y, w, h, std::size_t(c));
      }
      const MetalRoughness texel = metal_roughness_of(d, s, glossiness * gloss_map.at(x, y, w, h, 0));
      for (int c = 0; c < 3; ++c) colours.push_back(to_srgb_byte(texel.base_colour[c]));
      metallic.push_back(to_byte(texel.metallic));
      roughness.push_back(to_byte(texel.roughness));
    }
  const TextureUse& use = of_diffuse ? diffuse : specular;
  const std::string name = of(of_diffuse ? of_diffuse : of_specular)->name;
  const int colour_map = bitmaps_.add(byte_bitmap(name, width, height, 3, colours));
  const int metal_map = bitmaps_.add(byte_bitmap(name, width, height, 1, metallic));
  const int rough_map = bitmaps_.add(byte_bitmap(name, width, height, 1, roughness));
  return Converted{add(use, colour_map, kSrgb, BitmapChannels::kAll),
                   add(use, metal_map, 1.0f, BitmapChannels::kBlue),
                   add(use, rough_map, 1.0f, BitmapChannels::kGreen)};
}

int TextureBuilder::scaled(int texture, const glm::vec3& factor) {
  if (factor == glm::vec3(1.0f)) return texture;
  scene_.textures.push_back({scene_.textures[std::size_t(texture)].name, ScaleTexture{factor, texture}});
  return int(scene_.textures.size()) - 1;
}

}  // namespace penumbra::gltf
