#include "gl/picture_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "scheduler/image/picture.h"

namespace penumbra {
namespace {

using Channels = std::array<std::string_view, 3>;
constexpr std::array<Channels, 3> kTriples{{{"R", "G", "B"}, {"X", "Y", "Z"}, {"U", "V", "U"}}};

bool is_identity(std::string_view layer, std::string_view component) {
  return layer.starts_with("Crypto") || component == "ID" || component == "id";
}

LayerKind kind_of(const ChannelName& name) {
  if (is_identity(name.layer, name.component)) return LayerKind::kIdentity;
  if (name.layer.find("normal") != std::string::npos || name.layer == "N") return LayerKind::kNormal;
  return LayerKind::kColor;
}

std::vector<float> values_of(const Image& image, std::span<const std::size_t> channels) {
  std::vector<float> values;
  values.reserve(image.pixels() * channels.size());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel)
    for (const std::size_t channel : channels)
      values.push_back(image.values[pixel * image.channels.size() + channel]);
  return values;
}

/// The channels of a layer that form a colour or a vector, if it has all three.
std::optional<std::array<std::size_t, 3>> triple_of(const std::map<std::string, std::size_t>& components) {
  for (const Channels& names : kTriples) {
    std::array<std::size_t, 3> found{};
    const bool all = std::ranges::all_of(
        names, [&](std::string_view name) { return components.contains(std::string(name)); });
    for (std::size_t i = 0; all && i < 3; ++i) found[i] = components.at(std::string(names[i]));
    if (all) return found;
  }
  return std::nullopt;
}

}  // namespace

const PictureLayer* LayeredPicture::layer(std::string_view layer_name) const {
  const auto found = std::ranges::find(layers, layer_name, &PictureLayer::name);
  return found == layers.end() ? nullptr : &*found;
}

PictureLayer make_layer(std::string name, LayerKind kind, std::vector<float> values, std::size_t per_pixel) {
  PictureLayer layer{.name = std::move(name), .kind = kind, .values = {}};
  if (per_pixel == 3) {
    layer.values = std::move(values);
  } else {
    layer.values.reserve(3 * values.size());
    for (const float value : values) layer.values.insert(layer.values.end(), 3, value);
  }
  find_range(layer);
  return layer;
}

void find_range(PictureLayer& layer) {
  layer.least = layer.most = 0;
  if (layer.kind != LayerKind::kQuantity) return;
  for (const float value : layer.values) {
    if (!(value > 0) || !std::isfinite(value)) continue;
    layer.least = layer.least > 0 ? std::min(layer.least, value) : value;
    layer.most = std::max(layer.most, value);
  }
}

LayeredPicture layers_of(const Image& image, std::string name) {
  LayeredPicture picture{.name = std::move(name),
                         .width = image.display.width,
                         .height = image.display.height,
                         .area = {image.data.x - image.display.x, image.data.y - image.display.y,
                                  image.data.width, image.data.height},
                         .layers = {}};
  if (const auto beauty = image.beauty_channels())
    picture.layers.push_back(
        make_layer(std::string(kImageLayer), LayerKind::kColor, values_of(image, *beauty), 3));
  std::map<std::string, std::map<std::string, std::size_t>> layers;
  for (std::size_t i = 0; i < image.channels.size(); ++i) {
    const ChannelName channel = split_channel(image.channels[i]);
    layers[std::string(channel.layer)][std::string(channel.component)] = i;
  }
  for (const auto& [layer, components] : layers) {
    const auto triple = triple_of(components);
    const bool is_beauty = layer.empty() && picture.layer(kImageLayer) != nullptr;
    const LayerKind kind = kind_of({layer, components.begin()->first});
    if (triple && kind != LayerKind::kIdentity && !is_beauty)
      picture.layers.push_back(
          make_layer(layer.empty() ? "colour" : layer, kind, values_of(image, *triple), 3));
    for (const auto& [component, channel] : components) {
      if (triple && kind != LayerKind::kIdentity && std::ranges::find(*triple, channel) != triple->end())
        continue;
      if (is_beauty && components.size() == 1) continue;  // a grey image
      // Of Cryptomatte's pairs the first is the ID that covers most, the second its share.
      if (layer.starts_with("Crypto") && component != "R") continue;
      const bool alone = components.size() == 1 || layer.starts_with("Crypto");
      const std::string shown = layer.empty() ? component : alone ? layer : layer + "." + component;
      const bool is_id = is_identity(layer, component);
      picture.layers.push_back(make_layer(shown, is_id ? LayerKind::kIdentity : LayerKind::kQuantity,
                                          values_of(image, std::array{channel}), 1));
    }
  }
  return picture;
}

Expected<Image> read_linear_image(const std::filesystem::path& path) {
  const Expected<Image> image = read_image(path);
  if (!image) return image;
  return linear_image(*image, "");
}

}  // namespace penumbra
