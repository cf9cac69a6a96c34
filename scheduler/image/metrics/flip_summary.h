// What both forms of FLIP share around flip_core.h: from a pair of images to planes, from errors to a result.
#pragma once

#include "scheduler/image/metrics/flip.h"
#include "scheduler/image/metrics/flip_core.h"

namespace penumbra {

Expected<void> check_flip_input(const ImagePair& pair, double pixels_per_degree);

/// light(i) of each value, as three planes; grey thrice, what is not finite black.
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

/// Mean and largest over the finite pixels.
FlipResult flip_summary(const ImagePair& pair, Plane error, double pixels_per_degree);

}  // namespace penumbra
