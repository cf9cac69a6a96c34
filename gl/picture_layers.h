// The layers of an image file, or of a saved state, as the window shows them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gl/image_view.h"
#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// How a layer's numbers are shown: as a colour, as 0.5 + 0.5 n, by a logarithmic colour map over the range
/// of the values, or as a colour of its own for each value.
enum class LayerKind { kColor, kNormal, kQuantity, kIdentity };

struct PictureLayer {
  std::string name;  ///< "image" for the beauty layer, else as in the file: "albedo", "depth"
  LayerKind kind = LayerKind::kColor;
  std::vector<float>
      values;  ///< three per pixel of the picture's area, from the top; quantities are repeated
  float least = 0,
        most = 0;         ///< of quantities: the smallest positive and the largest finite value, 0 if none
  bool has_gaps = false;  ///< NaN stands for pixels without a value
};

struct LayeredPicture {
  std::string name;           ///< for display
  int width = 0, height = 0;  ///< of the film
  PixelRectangle area;        ///< the part of the film that has values
  std::vector<PictureLayer> layers;
  [[nodiscard]] const PictureLayer* layer(std::string_view layer_name) const;
};

/// The beauty layer's name.
constexpr std::string_view kImageLayer = "image";

/// Sets `least` and `most`.
void find_range(PictureLayer& layer);

/// A layer from `per_pixel` values a pixel: 1 (repeated) or 3.
PictureLayer make_layer(std::string name, LayerKind kind, std::vector<float> values, std::size_t per_pixel);

/// Groups channels into layers: NAME.R, .G, .B or NAME.X, .Y, .Z are one; any other channel is a layer of its
/// own.
LayeredPicture layers_of(const Image& image, std::string name);

/// Reads an image in any format of OpenImageIO. Formats of displays (PNG, JPEG, …) are made linear. Errors:
/// those of read_image.
Expected<Image> read_linear_image(const std::filesystem::path& path);

}  // namespace penumbra
