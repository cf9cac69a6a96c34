#include "scheduler/image/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "scenes/names.h"
#include "scheduler/image/metrics/color_space.h"
#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {
namespace {

constexpr std::array<std::uint8_t, 3> kMagenta{255, 0, 255};
constexpr double kNearest = 0.1;  // what is nearest differs from nothing, which is black

enum class Shown { kColour, kDifference, kNormal, kRange };

/// The channels of a layer, and how they are shown.
struct ShownLayer {
  std::vector<std::size_t> channels;  ///< one or three
  std::optional<std::size_t> alpha;
  Shown shown = Shown::kColour;
};

bool is_beauty_name(std::string_view layer) { return layer.empty() || layer == "beauty"; }

Shown way_to_show(std::string_view name, const LayerChannels& layer) {
  const std::string lower = to_lower_case(name);
  const auto is_named = [&](std::string_view word) { return lower.find(word) != std::string::npos; };
  const std::string_view last = split_channel(layer.names.back()).component;
  if (layer.names.size() == 3 && last == "Z" && is_named("normal") && !is_named("variance"))
    return Shown::kNormal;
  if (layer.names.size() == 1 && (last == "Z" || is_named("depth") || is_named("samples")))
    return Shown::kRange;
  return lower == "difference" ? Shown::kDifference : Shown::kColour;
}

/// The layer's channels; one of four is alpha.
Expected<ShownLayer> shown_layer(const Image& image, const std::string& name) {
  auto found = layer_channels(image, name);
  if (!found) return std::unexpected(found.error());
  if (name.starts_with("Crypto"))
    return fail(fmt::format("'{}' holds IDs, of which there is no picture; an .exr keeps them", name));
  ShownLayer layer;
  layer.alpha = is_beauty_name(name) ? image.channel("A") : std::nullopt;
  if (!is_beauty_name(name) && found->names.size() == 4 && split_channel(found->names[3]).component == "A") {
    layer.alpha = found->indices[3];
    found->indices.pop_back();
    found->names.pop_back();
  }
  if (found->indices.size() != 1 && found->indices.size() != 3)
    return fail(fmt::format("'{}' has {} channels, of which there is no picture; choose one, as in {}", name,
                            found->indices.size(), found->names.front()));
  layer.shown = is_beauty_name(name) ? Shown::kColour : way_to_show(name, *found);
  layer.channels = found->indices;
  return layer;
}

std::uint8_t signal_byte(double signal) {
  return std::uint8_t(std::lround(255 * std::clamp(signal, 0.0, 1.0)));
}

struct Range {
  float low = std::numeric_limits<float>::infinity(), high = 0;
};

Range range_of(const Image& image, std::size_t channel) {
  Range range;
  for (std::size_t i = channel; i < image.values.size(); i += image.channels.size()) {
    const float value = image.values[i];
    if (!std::isfinite(value) || value == 0) continue;
    range.high = range.low <= range.high ? std::max(range.high, value) : value;
    range.low = std::min(range.low, value);
  }
  return range;
}

/// Converts one pixel after the other.
class Painter {
 public:
  Painter(const Image& image, const ShownLayer& layer, const PictureOptions& options)
      : layer_(layer), tone_(options.tone), gain_(std::exp2(options.exposure)) {
    if (layer.shown == Shown::kRange) range_ = range_of(image, layer.channels[0]);
  }

  [[nodiscard]] const Range& range() const { return range_; }

  /// The bytes of a pixel with these colours, which are finite.
  [[nodiscard]] std::array<std::uint8_t, 3> bytes_of(const Color& color) const {
    std::array<std::uint8_t, 3> bytes{};
    const Color mapped = layer_.shown == Shown::kColour ? exposed(color) : color;
    for (std::size_t c = 0; c < 3; ++c) bytes[c] = byte_of(mapped[c]);
    return bytes;
  }

 private:
  [[nodiscard]] Color exposed(Color color) const {
    for (double& x : color) x *= gain_;
    return tone_mapped(tone_, color);
  }
  [[nodiscard]] std::uint8_t byte_of(double x) const {
    switch (layer_.shown) {
      case Shown::kDifference: {
        const double size = srgb_from_linear(std::min(std::abs(x * gain_), 1.0));
        return signal_byte(0.5 + (x < 0 ? -0.5 : 0.5) * size);
      }
      case Shown::kNormal:
        return signal_byte(0.5 + 0.5 * x);
      case Shown::kRange: {
        if (x == 0) return 0;
        const double span = double(range_.high) - range_.low;
        return signal_byte(span > 0 ? kNearest + (1 - kNearest) * (x - range_.low) / span : 1);
      }
      case Shown::kColour:
        break;
    }
    return display_byte(float(x));
  }

  const ShownLayer& layer_;
  ToneOperator tone_;
  double gain_;
  Range range_;
};

/// The image with linear light instead of the signals of a display. Colours remain multiplied by alpha.
Image made_linear(Image image) {
  if (!is_display_image(image)) return image;
  const auto alpha = image.channel("A");
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    float* values = &image.values[pixel * image.channels.size()];
    const float covered = alpha && values[*alpha] > 0 ? values[*alpha] : 1.0f;
    for (std::size_t c = 0; c < image.channels.size(); ++c)
      if (c != alpha)
        values[c] = float(linear_from_srgb(std::min(1.0, double(values[c]) / covered)) * covered);
  }
  std::erase_if(image.metadata, [](const auto& entry) { return entry.first == "oiio:ColorSpace"; });
  return image;
}

std::string range_remark(const std::string& name, const Range& range) {
  if (!(range.low <= range.high)) return fmt::format("{} is 0, which is black", name);
  return fmt::format("{} from {:.6g} (dark) to {:.6g} (white); 0 is black", name, range.low, range.high);
}

}  // namespace

bool is_image_name(const std::filesystem::path& path) {
  static constexpr std::array<std::string_view, 17> kEndings = {
      ".exr", ".hdr", ".rgbe", ".pfm", ".png", ".jpg", ".jpeg", ".tif", ".tiff",
      ".tga", ".bmp", ".ppm",  ".pgm", ".pnm", ".dpx", ".webp", ".gif"};
  return std::ranges::find(kEndings, extension_of(path)) != kEndings.end();
}

Expected<LayerPicture> picture_of(const Image& image, const PictureOptions& options) {
  const auto layer = shown_layer(image, options.layer);
  if (!layer) return std::unexpected(layer.error());
  if (is_display_image(image)) return picture_of(made_linear(image), options);
  const Painter painter(image, *layer, options);
  LayerPicture picture{.has_alpha = layer->alpha.has_value(), .pixels = {}};
  picture.pixels.reserve(image.pixels() * (picture.has_alpha ? 4 : 3));
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    const float* values = &image.values[pixel * image.channels.size()];
    const float alpha = layer->alpha ? values[*layer->alpha] : 1.0f;
    // Where alpha is 0 but colours are not, for example in front of a visible light, colours are not divided.
    const float covered = alpha > 0 ? alpha : 1.0f;
    Color color{};
    bool is_finite = std::isfinite(alpha);
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = values[layer->channels[layer->channels.size() == 3 ? c : 0]];
      is_finite = is_finite && std::isfinite(value);
      color[c] = double(value / covered);
    }
    picture.non_finite += is_finite ? 0 : 1;
    const auto bytes = is_finite ? painter.bytes_of(color) : kMagenta;
    picture.pixels.insert(picture.pixels.end(), bytes.begin(), bytes.end());
    if (picture.has_alpha) picture.pixels.push_back(is_finite ? signal_byte(alpha) : 255);
  }
  if (layer->shown == Shown::kRange) picture.remark = range_remark(options.layer, painter.range());
  return picture;
}

Expected<Image> linear_image(const Image& image, const std::string& layer) {
  Image result = made_linear(image);
  if (layer.empty()) return result;
  auto found = layer_channels(image, layer);
  if (!found) return std::unexpected(found.error());
  if (const auto alpha = image.channel("A"); alpha && is_beauty_name(layer)) {
    found->indices.push_back(*alpha);
    found->names.emplace_back("A");
  }
  const bool is_colour = split_channel(found->names.front()).component == "R" && found->names.size() >= 3;
  result.channels.clear();
  for (const std::string& name : found->names)
    result.channels.push_back(is_colour ? std::string(split_channel(name).component) : name);
  std::vector<float> values;
  values.reserve(image.pixels() * found->indices.size());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel)
    for (const std::size_t channel : found->indices)
      values.push_back(result.values[pixel * image.channels.size() + channel]);
  result.values = std::move(values);
  if (!layer.starts_with("Crypto"))
    std::erase_if(result.metadata, [](const auto& entry) { return entry.first.starts_with("cryptomatte/"); });
  result.metadata.emplace_back("penumbra:layer", layer);
  return result;
}

std::uint64_t non_finite_pixels(const Image& image) {
  std::uint64_t count = 0;
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    const auto first = image.values.begin() + std::ptrdiff_t(pixel * image.channels.size());
    count += std::all_of(first, first + std::ptrdiff_t(image.channels.size()),
                         [](float value) { return std::isfinite(value); })
                 ? 0
                 : 1;
  }
  return count;
}

Expected<Image> display_image(const Image& image) {
  const auto beauty = image.beauty_channels();
  if (!beauty) return fail("there are no channels R, G, B");
  LayerPicture picture;
  if (!is_display_image(image)) {
    auto made = picture_of(image);
    if (!made) return std::unexpected(made.error());
    picture = std::move(*made);
  }
  const std::size_t channels = picture.has_alpha ? 4 : 3;
  Image result;
  result.data = image.data;
  result.display = image.display;
  result.channels = {"R", "G", "B"};
  result.metadata = {{"oiio:ColorSpace", "sRGB"}};
  result.values.reserve(3 * image.pixels());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = image.values[pixel * image.channels.size() + (*beauty)[c]];
      int byte = 0;
      if (picture.pixels.empty()) {
        byte = int(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
      } else {
        // OpenImageIO multiplies by alpha with integers.
        const std::uint8_t* bytes = &picture.pixels[pixel * channels];
        byte = bytes[c] * (picture.has_alpha ? bytes[3] : 255) / 255;
      }
      result.values.push_back(std::isfinite(value) ? float(byte) / 255.0f : value);
    }
  }
  return result;
}

}  // namespace penumbra
