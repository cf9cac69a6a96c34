// A layer of an image as a display shows it: the bytes of a PNG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {

/// Whether a file's name ends as images do, of any format that read_image reads; everything else is a scene.
bool is_image_name(const std::filesystem::path& path);

struct PictureOptions {
  std::string layer = {};  ///< as for layer_channels; empty: the beauty layer
  double exposure = 0;     ///< stops: radiance is multiplied by 2^exposure
  ToneOperator tone = ToneOperator::kClamp;
};

struct LayerPicture {
  bool has_alpha = false;
  std::vector<std::uint8_t> pixels;  ///< red, green, blue (and alpha) of the data window, from the top
  std::uint64_t non_finite = 0;      ///< pixels with a value that is NaN or infinite; they are magenta
  std::string remark = {};           ///< the scale of distances and counts, for users; empty: none
};

/// The picture of a layer:
///   colours       tone_mapped and srgb_from_linear; a single channel is grey. With alpha (of the beauty
///                 layer, or in the layer) they are divided by it, as PNG requires
///   difference    0.5 + 0.5 sign(x) srgb_from_linear(|x|), after exposure
///   normals       0.5 + 0.5 n, without transfer function
///   depth, samples  from the smallest to the largest finite value that is not 0: 0.1 to 1, without transfer
///                 function; 0 is black
/// The last two ignore exposure and tone. Signals of a display (see is_display_image) are made linear before.
/// Errors: no such layer, two or more than four channels, IDs of Cryptomatte.
Expected<LayerPicture> picture_of(const Image& image, const PictureOptions& options = {});

/// The layer alone, linear, with windows, camera and metadata: colours are renamed to R, G, B and A, other
/// channels keep their names. With an empty name all channels.
Expected<Image> linear_image(const Image& image, const std::string& layer);

/// The number of pixels with a channel that is NaN or infinite.
std::uint64_t non_finite_pixels(const Image& image);

/// The beauty layer as it is read from the PNG that `encode_png` makes of a linear image: R, G, B from 0 to 1
/// in steps of 1/255, multiplied by alpha. Values that are NaN or infinite stay so, while a PNG marks them.
/// The values of a display-referred image are rounded to those steps. Error: there is no beauty layer.
Expected<Image> display_image(const Image& image);

}  // namespace penumbra
