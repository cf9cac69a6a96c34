// The merged film as an image with layers.
#pragma once

#include <cstdint>

#include "scenes/matte_names.h"
#include "scheduler/image/image.h"
#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// M2 / (n (n - 1)), the unbiased estimate of the variance of a mean of `count` samples; 0 where it has none
/// (n < 2).
double variance_of_mean(std::uint64_t count, double m2);

/// How many samples the pixels of a film have.
struct SampleRange {
  std::uint64_t least = 0, most = 0;  ///< of a pixel
  std::uint64_t total = 0;
};
SampleRange sample_range(const FilmAccumulator& film);

/// Pixels with a variance that no float holds: infinite in the image, while it is finite in the film.
std::uint64_t pixels_of_infinite_variance(const FilmAccumulator& film);

/// Layers, by OpenEXR's naming convention, the film's rectangle as data window in a film of `film_width` x
/// `film_height`:
///   R G B             mean radiance, linear Rec. 709
///   A                 the coverage, where the film has it; R, G, B are premultiplied by it
///   variance.R/G/B    variance of that mean
///   albedo.R/G/B, normal.X/Y/Z, depth.Z, analytic.R/G/B, difference.R/G/B, visibility.Y
///                     those of kernels/film_layers.h that the film has
///   samples.Y         n; 0 where no pass has been merged, and everything else is 0 there
///   CryptoObject00.R … CryptoMaterial02.A
///                     with `mattes`, of which the film has to be: see cryptomatte.h
Image image_of_film(const FilmAccumulator& film, int film_width, int film_height,
                    const MatteNames* mattes = nullptr);

}  // namespace penumbra
