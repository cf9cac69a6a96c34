// An image in memory with the channels, windows and metadata of an OpenEXR file.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/host/chromaticities.h"
#include "kernels/host/error.h"

namespace penumbra {

/// A rectangle of pixels; y points downwards.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelWindow&) const = default;
};

using MetadataValue = std::variant<int, float, double, std::string>;

/// A matrix M for row vectors, p' = (x, y, z, 1) M, stored by rows.
using RowMatrix = std::array<float, 16>;

/// The pinhole camera as in OpenEXR's standard attributes.
struct ImageCamera {
  RowMatrix world_to_camera;  ///< camera space: x to the right of the image, y up, z along the view direction
  /// NDC: (0, 0) and (1, 1) are the upper left and lower right corner of the display window.
  /// Nothing for a panorama.
  std::optional<RowMatrix> world_to_ndc;
  bool operator==(const ImageCamera&) const = default;
};

/// Channel c of pixel (x, y), relative to the corner of `data`, is `values[(y * data.width + x) *
/// channels.size() + c]`.
struct Image {
  PixelWindow data;     ///< the existing pixels: the crop window
  PixelWindow display;  ///< the whole film
  std::vector<std::string> channels;
  std::vector<float> values;
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  std::optional<Chromaticities> chromaticities = {};  ///< of R, G, B, if known
  std::optional<ImageCamera> camera = {};             ///< if known
  /// The number of channels at the end whose values must be stored exactly, for example hashes.
  std::size_t exact_channels = 0;

  [[nodiscard]] std::size_t pixels() const { return std::size_t(data.width) * std::size_t(data.height); }
  /// The index of the channel of that name.
  [[nodiscard]] std::optional<std::size_t> channel(std::string_view name) const;
  /// The indices of red, green and blue of the beauty layer, which consists of the channels R, G, B. For a
  /// grey image (Y, or a single channel) all three are the same. Nothing if there is no beauty layer.
  [[nodiscard]] std::optional<std::array<std::size_t, 3>> beauty_channels() const;
  /// The metadata entry of that name, if it exists.
  [[nodiscard]] std::optional<MetadataValue> attribute(std::string_view name) const;
  [[nodiscard]] float at(int x, int y, std::size_t channel_index) const {
    return values[(std::size_t(y) * std::size_t(data.width) + std::size_t(x)) * channels.size() +
                  channel_index];
  }
};

/// A metadata entry as text; empty if there is none.
std::string metadata_text(const Image& image, std::string_view name);

/// The parts of a channel's name: "albedo" and "R" of albedo.R; no layer for R.
struct ChannelName {
  std::string_view layer, component;
};
ChannelName split_channel(std::string_view channel);

/// Whether the values are signals of a display (sRGB), as OpenImageIO reports for PNG and JPEG, not radiance.
bool is_display_image(const Image& image);

/// Whether metadata of that name describe a file, such as its compression, and not the picture in it. A file
/// written anew must not have them.
bool describes_file(std::string_view name);

constexpr double kMostImageBytes = 16.0 * 1024 * 1024 * 1024;

/// Reads an image in any format of OpenImageIO: the first part, full resolution, converted to float. Values
/// are as stored (integers scaled to 0…1, no transfer function applied). Errors: missing, truncated, unknown
/// format, deep, or larger than 16 GiB in memory.
Expected<Image> read_image(const std::filesystem::path& path);
/// The same without `values`.
Expected<Image> read_image_header(const std::filesystem::path& path);

}  // namespace penumbra
