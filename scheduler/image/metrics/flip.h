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

/// The papers' viewing conditions: 0.7 m from a screen that is 0.7 m and 3840 pixels wide; 67.02 pixels per
/// degree.
constexpr double kFlipPixelsPerDegree = 3840 * std::numbers::pi / 180;

/// Exposures in stops (powers of two).
struct FlipExposures {
  /// With `start` the brightest pixel is darkened, with `stop` the median is brightened.
  double start = 0, stop = 0;
  int count = 1;  ///< number of evenly spaced exposures, including both ends
  bool operator==(const FlipExposures&) const = default;
};

struct FlipResult {
  double mean = 0;     ///< over the pixels that are finite in all images; in [0, 1]
  double largest = 0;  ///< the largest error of a pixel
  int x = 0, y = 0;    ///< that pixel, in film coordinates
  /// The error in [0, 1] of each pixel of the window; NaN where an image is not finite.
  std::vector<float> pixels;
  double pixels_per_degree = kFlipPixelsPerDegree;
  bool hdr = false;
  FlipExposures exposures;  ///< only for HDR-FLIP
};

/// LDR-FLIP of display images: sRGB signals, clamped to [0, 1], with three channels R, G, B or one grey
/// channel. For their neighbours, pixels that are not finite are black. It is symmetric, and 0 for equal
/// images. Errors: not 1 or 3 channels; `pixels_per_degree` outside [1, 10000].
Expected<FlipResult> flip_of_display_images(const ImagePair& pair,
                                            double pixels_per_degree = kFlipPixelsPerDegree);

/// HDR-FLIP of linear radiance: for each pixel the largest LDR-FLIP over several exposures, which the
/// reference determines (see flip_exposures), with the ACES tone map. Negative radiance is treated as 0.
/// Errors: as above.
Expected<FlipResult> flip_of_radiance(const ImagePair& pair, double pixels_per_degree = kFlipPixelsPerDegree);

/// The papers' rule. Let x be the radiance that the tone map maps to 0.85. Then start = log2(x / largest
/// luminance of the reference), stop = log2(x / median luminance), count = max(2, ceil(stop - start)). If the
/// median is 0, the median of the positive luminances is used. A black reference gets only exposure 0.
FlipExposures flip_exposures(const ImagePair& pair);

/// Narkowicz' fit of the ACES tone map without its exposure of 0.6: from linear radiance x >= 0 to linear
/// light for a display, clamped to [0, 1].
double aces_tone_map(double radiance);

}  // namespace penumbra
