// The images that errors are measured against.
#pragma once

#include <optional>

#include "scheduler/image/image.h"
#include "scheduler/image/metrics/image_pair.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// One image, or two whose noise is independent: then squared errors are (x - A)(x - B), free of that noise.
struct Reference {
  Image first;
  std::optional<Image> second;

  /// The image against the reference; errors as pair_images.
  [[nodiscard]] Expected<ImagePair> pair(const Image& image) const;
  [[nodiscard]] PixelWindow window() const { return first.data; }
};

/// Mean of A - B over pixels and channels in units of its standard error, by the spread over the pixels: 0
/// for two halves that differ in nothing, about a standard normal where both estimate the same.
double halves_z(const Image& a, const Image& b);

/// What the noise of a reference that stands alone adds to MSE and relMSE, by its layer `variance`; nothing
/// where it has none.
struct ReferenceNoise {
  double mse = 0, relmse = 0;
};
std::optional<ReferenceNoise> reference_noise(const Image& reference, double epsilon);

}  // namespace penumbra
