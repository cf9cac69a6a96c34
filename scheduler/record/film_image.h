// Converts the merged film to an image with layers.
#pragma once

#include <cstdint>

#include "scenes/matte_names.h"
#include "scheduler/image/image.h"
#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// M2 / (n (n - 1)): the unbiased estimate of the variance of the mean of n = `count` samples; 0 for n < 2.
double variance_of_mean(std::uint64_t count, double m2);

/// The numbers of samples of a film's pixels.
struct SampleRange {
  std::uint64_t least = 0, most = 0;  ///< the smallest and the largest number of a pixel
  std::uint64_t total = 0;
};
SampleRange sample_range(const FilmAccumulator& film);

/// The number of pixels with a variance that overflows a float: infinite in the image, but finite in the
/// film.
std::uint64_t pixels_of_infinite_variance(const FilmAccumulator& film);

/// The image of a film. Layers have OpenEXR's naming convention. The data window is the film's rectangle in a
/// film of `film_width` x `film_height`:
///      R G B             mean radiance, linear Rec. 709
///      A                 coverage, if the film has it; R, G, B are then premultiplied
///      variance.R/G/B    variance of that mean
///      albedo.R/G/B, normal.X/Y/Z, depth.Z, analytic.R/G/B, difference.R/G/B, visibility.Y
///                        the layers of kernels/film_layers.h that the film has
///      albedo_variance.R/G/B, normal_variance.X/Y/Z, depth_variance.Z, half_a.R/G/B, half_b.R/G/B
///                        with FEATURE_DENOISING: variances of these means, and the means of two halves of
///                        the samples; a half without samples is 0
///      position.X/Y/Z, uv.U/V, geometric_normal.X/Y/Z, shape.ID, direct.R/G/B, indirect.R/G/B,
///      motion.X/Y/Z/W    those that are asked for (film.layers)
///      samples.Y         n; 0 where no pass has been merged, and everything else is 0 there
///      CryptoObject00.R … CryptoMaterial02.A
///                        with `mattes`, which must belong to the film's scene: see cryptomatte.h
Image image_of_film(const FilmAccumulator& film, int film_width, int film_height,
                    const MatteNames* mattes = nullptr);

}  // namespace penumbra
