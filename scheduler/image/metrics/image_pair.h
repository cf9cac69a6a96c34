// Matches two images for comparison: the same pixels and channels in the same order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// An image A, its reference B and optionally a second, independent reference. Value c of pixel p, in row
/// order from the corner of `window`, is `image[p * channels.size() + c]`, and likewise for the references.
struct ImagePair {
  PixelWindow window;                 ///< in film coordinates
  std::vector<std::string> channels;  ///< names in A: R, G, B, or one name for grey images
  std::vector<float> image, reference;
  std::vector<float> second_reference;  ///< empty if there is none
  std::vector<std::uint8_t> finite;     ///< for each pixel 1 if all values of all images are finite, else 0
  std::uint64_t compared_pixels = 0;    ///< number of such pixels; only these are used by metrics
  std::uint64_t image_non_finite = 0;   ///< pixels of A with a NaN or an infinity
  std::uint64_t reference_non_finite = 0;  ///< the same for either reference; a pixel may count in both

  [[nodiscard]] std::size_t pixels() const { return finite.size(); }
  [[nodiscard]] double value(std::size_t i) const { return image[i]; }
  /// The reference, or the mean of both.
  [[nodiscard]] double truth(std::size_t i) const {
    return second_reference.empty() ? double(reference[i])
                                    : 0.5 * (double(reference[i]) + double(second_reference[i]));
  }
  /// A minus the reference.
  [[nodiscard]] double difference(std::size_t i) const { return value(i) - truth(i); }
  /// (A - B)^2. With two references it is (A - B1)(A - B2): their errors are independent, so they cancel in
  /// its expectation. The product may be negative.
  [[nodiscard]] double squared_difference(std::size_t i) const {
    const double d = value(i) - double(reference[i]);
    return second_reference.empty() ? d * d : d * (value(i) - double(second_reference[i]));
  }
};

/// The indices and names of a layer's channels in an image. "" and "beauty" are R, G, B, or one index in a
/// grey image; "albedo" is albedo.R, albedo.G, albedo.B; the full name of a channel is only that channel.
/// Errors: no such layer; the message lists the existing ones.
struct LayerChannels {
  std::vector<std::size_t> indices;
  std::vector<std::string> names;
};
Expected<LayerChannels> layer_channels(const Image& image, std::string_view layer);

/// Matches the images. For `layer` see `layer_channels`. A grey image can be compared with a coloured one.
/// `second_reference` may be null. Errors, with the properties of both sides: sizes or positions of the data
/// windows differ, a layer is missing or has other channels, no pixel is finite in all images.
Expected<ImagePair> pair_images(const Image& image, const Image& reference,
                                const Image* second_reference = nullptr, std::string_view layer = {});

/// Means over blocks of side x side pixels, aligned in film coordinates. Blocks at the film's edge are
/// smaller. Blocks with a pixel that is not finite are left out. Metrics of the result measure the error from
/// a larger viewing distance, or after a filter: noise of opposite sign in nearby pixels cancels. `side` is
/// at least 1.
ImagePair block_means(const ImagePair& pair, int side);

}  // namespace penumbra
