// Two images brought together for comparison: the same pixels, the same channels, in the same order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// An image A, its reference B and perhaps a second, independent reference. Value c of pixel p, counted row
/// by row from the corner of `window`, is `image[p * channels.size() + c]`, and likewise for the others.
struct ImagePair {
  PixelWindow window;                 ///< in film coordinates
  std::vector<std::string> channels;  ///< names in A: R, G, B, or one name for grey images
  std::vector<float> image, reference;
  std::vector<float> second_reference;     ///< empty if there is none
  std::vector<std::uint8_t> finite;        ///< of each pixel: 1 where all values of all images are finite
  std::uint64_t compared_pixels = 0;       ///< of which all values are finite; only these count in metrics
  std::uint64_t image_non_finite = 0;      ///< pixels of A with a NaN or an infinity
  std::uint64_t reference_non_finite = 0;  ///< likewise of either reference; a pixel may count in both

  [[nodiscard]] std::size_t pixels() const { return finite.size(); }
  [[nodiscard]] double value(std::size_t i) const { return image[i]; }
  /// The reference, or the mean of both.
  [[nodiscard]] double truth(std::size_t i) const {
    return second_reference.empty() ? double(reference[i])
                                    : 0.5 * (double(reference[i]) + double(second_reference[i]));
  }
  /// A minus the reference.
  [[nodiscard]] double difference(std::size_t i) const { return value(i) - truth(i); }
  /// (A - B)^2; with two references (A - B1)(A - B2), whose expectation is free of their noise because their
  /// errors are independent and cancel. Such a product may be negative.
  [[nodiscard]] double squared_difference(std::size_t i) const {
    const double d = value(i) - double(reference[i]);
    return second_reference.empty() ? d * d : d * (value(i) - double(second_reference[i]));
  }
};

/// Where a layer's channels are in an image: indices and names. "" and "beauty" are R, G, B, or one index
/// where the image is grey; "albedo" is albedo.R, albedo.G, albedo.B; a channel's full name is that channel
/// alone. Errors: no such layer; the message names those that there are.
struct LayerChannels {
  std::vector<std::size_t> indices;
  std::vector<std::string> names;
};
Expected<LayerChannels> layer_channels(const Image& image, std::string_view layer);

/// `layer` as in `layer_channels`. A grey image compares with a coloured one. `second_reference` may be null.
/// Errors, naming both sides: sizes or positions of the data windows differ, a layer is missing or has other
/// channels, no pixel is finite in all images.
Expected<ImagePair> pair_images(const Image& image, const Image& reference,
                                const Image* second_reference = nullptr, std::string_view layer = {});

/// Means over blocks of side x side pixels, aligned in film coordinates; those at the film's edge hold fewer.
/// Blocks with a pixel that is not finite are left out. Metrics of the result tell how large the error is
/// from a larger viewing distance, or after a filter: noise of opposite sign in nearby pixels cancels. `side`
/// at least 1.
ImagePair block_means(const ImagePair& pair, int side);

}  // namespace penumbra
