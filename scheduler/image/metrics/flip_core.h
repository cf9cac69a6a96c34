// Steps that both forms of FLIP share: converting a pair of images to planes, LDR-FLIP on linear light, and
// summarising errors.
#pragma once

#include <array>

#include "scheduler/image/metrics/flip.h"
#include "scheduler/image/metrics/flip_filters.h"

namespace penumbra {

/// Linear R, G, B for a display, each in [0, 1].
using LinearPlanes = std::array<Plane, 3>;

Expected<void> check_flip_input(const ImagePair& pair, double pixels_per_degree);

/// Three planes of light(i) for each value. A grey channel is used three times; values that are not finite
/// become black.
template <typename Light>
LinearPlanes planes_of(const ImagePair& pair, Light light) {
  const std::size_t channels = pair.channels.size();
  LinearPlanes planes;
  planes.fill(Plane(pair.window.width, pair.window.height));
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (!pair.finite[pixel]) continue;
    for (std::size_t c = 0; c < 3; ++c)
      planes[c].values[pixel] = float(light(pixel * channels + (channels == 3 ? c : 0)));
  }
  return planes;
}

/// The error of each pixel, in [0, 1].
Plane flip_of_linear_light(const LinearPlanes& reference, const LinearPlanes& image,
                           double pixels_per_degree);

/// The mean and the largest error over the finite pixels.
FlipResult flip_summary(const ImagePair& pair, Plane error, double pixels_per_degree);

}  // namespace penumbra
