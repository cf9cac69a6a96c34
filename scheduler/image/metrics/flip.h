// FLIP: the difference that an observer perceives when flipping between two images on a screen.
//
// Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild 2020, "FLIP: a difference evaluator for
// alternating images" (LDR-FLIP); Andersson, Nilsson, Shirley, Akenine-Möller 2021, "Visualizing errors in
// rendered high dynamic range images" (HDR-FLIP). Written from the formulas in these papers.
#pragma once

#include <numbers>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// The papers' observer: 0.7 m from a screen 0.7 m and 3840 pixels wide; 67.02 pixels per degree.
constexpr double kFlipPixelsPerDegree = 3840 * std::numbers::pi / 180;

/// Exposures in stops (factors of two).
struct FlipExposures {
  double start = 0, stop = 0;  ///< start darkens the brightest pixel, stop brightens the median
  int count = 1;               ///< evenly spaced, both ends included
  bool operator==(const FlipExposures&) const = default;
};

struct FlipResult {
  double mean = 0;            ///< over the pixels that are finite in all images, in [0, 1]
  double largest = 0;         ///< of a pixel ...
  int x = 0, y = 0;           ///< ... here, in film coordinates
  std::vector<float> pixels;  ///< error in [0, 1] of each pixel of the window; NaN where not finite
  double pixels_per_degree = kFlipPixelsPerDegree;
  bool hdr = false;
  FlipExposures exposures;  ///< of HDR-FLIP
};

/// LDR-FLIP of images for a display: sRGB signals, clamped to [0, 1]. Three channels R, G, B, or one as grey.
/// Not finite pixels count as black for their neighbours. Symmetric, 0 for equal images. `pixels_per_degree`
/// > 0. Errors: not 1 or 3 channels, `pixels_per_degree` outside [1, 10000].
Expected<FlipResult> flip_of_display_images(const ImagePair& pair,
                                            double pixels_per_degree = kFlipPixelsPerDegree);

/// HDR-FLIP of linear radiance: of each pixel the largest LDR-FLIP over exposures that the reference
/// determines, see flip_exposures, under the ACES tone map. Negative radiance counts as 0. Errors: as above.
Expected<FlipResult> flip_of_radiance(const ImagePair& pair, double pixels_per_degree = kFlipPixelsPerDegree);

/// The papers' rule: with x the radiance that the tone map takes to 0.85, start = log2(x / largest luminance
/// of the reference), stop = log2(x / median luminance), count = max(2, ceil(stop - start)). Where the median
/// is 0, that of the luminances above 0; a black reference: exposure 0 alone.
FlipExposures flip_exposures(const ImagePair& pair);

/// Narkowicz' fit of the ACES tone map, without its exposure of 0.6: linear radiance x >= 0 to linear light
/// for the display, clamped to [0, 1].
double aces_tone_map(double radiance);

}  // namespace penumbra
