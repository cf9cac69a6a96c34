// An image in memory, with the channels, windows and metadata of an OpenEXR file.
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

/// A rectangle of pixels; y grows downwards.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelWindow&) const = default;
};

using MetadataValue = std::variant<int, float, double, std::string>;

/// Of row vectors, p' = (x, y, z, 1) M: by rows.
using RowMatrix = std::array<float, 16>;

/// Where the pinhole stands, as OpenEXR's standard attributes have it.
struct ImageCamera {
  RowMatrix world_to_camera;  ///< x to the right of the image, y upwards, z along the view
  RowMatrix world_to_ndc;     ///< (0, 0) and (1, 1): upper left and lower right corner of the display window
  bool operator==(const ImageCamera&) const = default;
};

/// Channel c of pixel (x, y), counted from the corner of `data`, is `values[(y * data.width + x) *
/// channels.size() + c]`.
struct Image {
  PixelWindow data;     ///< the pixels that there are: the crop
  PixelWindow display;  ///< the whole film
  std::vector<std::string> channels;
  std::vector<float> values;
  std::vector<std::pair<std::string, MetadataValue>> metadata;
  std::optional<Chromaticities> chromaticities = {};  ///< of R, G, B, if it is said
  std::optional<ImageCamera> camera = {};             ///< likewise
  /// The last so many channels are numbers of which no file may lose a bit.
  std::size_t exact_channels = 0;

  [[nodiscard]] std::size_t pixels() const { return std::size_t(data.width) * std::size_t(data.height); }
  /// Index of the channel of that name.
  [[nodiscard]] std::optional<std::size_t> channel(std::string_view name) const;
  /// Indices of red, green and blue of the beauty layer, which is the channels R, G, B; a grey image (Y, or
  /// only one channel) is all three. Nothing if there is no such layer.
  [[nodiscard]] std::optional<std::array<std::size_t, 3>> beauty_channels() const;
  /// The metadata of that name; nothing if there is none.
  [[nodiscard]] std::optional<MetadataValue> attribute(std::string_view name) const;
  [[nodiscard]] float at(int x, int y, std::size_t channel_index) const {
    return values[(std::size_t(y) * std::size_t(data.width) + std::size_t(x)) * channels.size() +
                  channel_index];
  }
};

/// Reads any image that OpenImageIO reads: the first part, full resolution, as float. Values are as stored
/// (integers scaled to 0…1, no transfer function undone). Errors: missing, truncated, of no known format,
/// deep, or larger than 16 GiB in memory.
Expected<Image> read_image(const std::filesystem::path& path);

}  // namespace penumbra
