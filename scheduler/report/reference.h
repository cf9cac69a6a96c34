// The reference images against which errors are measured.
#pragma once

#include <optional>

#include "scheduler/image/image.h"
#include "scheduler/image/metrics/image_pair.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// One image, or two with independent noise A and B. With two, squared errors are (x - A)(x - B), whose
/// expectation is free of that noise.
struct Reference {
  Image first;
  std::optional<Image> second;

  /// Pairs an image with the reference. Errors: those of pair_images.
  [[nodiscard]] Expected<ImagePair> pair(const Image& image) const;
  [[nodiscard]] PixelWindow window() const { return first.data; }
};

/// The mean of A - B over pixels and channels, divided by its standard error, which is estimated from the
/// variation over the pixels. 0 if both are equal; approximately standard normal if both estimate the same
/// image.
double halves_z(const Image& a, const Image& b);

/// The amounts that the noise of a single reference adds to MSE and relMSE, from its layer `variance`.
/// Nothing if it has none.
struct ReferenceNoise {
  double mse = 0, relmse = 0;
};
std::optional<ReferenceNoise> reference_noise(const Image& reference, double epsilon);

}  // namespace penumbra
