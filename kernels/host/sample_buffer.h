// What a worker returns for one work unit: per-pixel statistics of the unit's samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/features.h"
#include "kernels/host/error.h"
#include "kernels/host/flagged_samples.h"
#include "kernels/unit.h"

namespace penumbra {

/// One float per pixel each. The first six are always there; the rest only when the job asks for feature
/// layers, and the last eight of them only where polygon lights have a closed form (FEATURE_POLYGONS). Behind
/// them, where it is asked for (FEATURE_COVERAGE), is one more: see coverage_plane_of.
enum SampleBufferPlane : int {
  kMeanR,
  kMeanG,
  kMeanB,  ///< mean radiance over the unit's samples, linear Rec. 709
  kDeviationR,
  kDeviationG,
  kDeviationB,  ///< standard deviation, sqrt(mean (sample - mean)^2): its square may be more than a float
                ///< holds
  kAlbedoR,
  kAlbedoG,
  kAlbedoB,  ///< mean reflectance at the first hit, 0 where nothing is hit
  kNormalX,
  kNormalY,
  kNormalZ,  ///< mean world-space shading normal at the first hit, 0 where nothing is hit
  kDepth,    ///< mean distance from the camera to the first hit, 0 where nothing is hit
  kAnalyticR,
  kAnalyticG,
  kAnalyticB,  ///< mean of the closed form: radiance by polygon lights without shadows
  kDifferenceR,
  kDifferenceG,
  kDifferenceB,  ///< mean of what the estimate of their light differs from it by, shadows above all: at most
                 ///< 0 in expectation
  kSeen,         ///< mean of the samples of their light, all channels together
  kWhole,        ///< likewise without shadows; the quotient of both is the visible share
  kSampleBufferPlanes,
  kRadiancePlanes = kAlbedoR,   ///< number of planes without feature layers
  kFeaturePlanes = kAnalyticR,  ///< ... without closed forms
};
static_assert(LAYER_PLANES_END == kSampleBufferPlanes);
static_assert(FIRST_LAYER_PLANE == kAlbedoR && ANALYTIC_PLANE == kAnalyticR &&
              DIFFERENCE_PLANE == kDifferenceR && SEEN_PLANE == kSeen && WHOLE_PLANE == kWhole);

/// How many of SampleBufferPlane the results of a scene with these FEATURE_* bits have.
constexpr int layer_planes_end(std::uint64_t features) {
  if ((features & FEATURE_LAYERS) == 0u) return kRadiancePlanes;
  return (features & FEATURE_POLYGONS) != 0 ? kSampleBufferPlanes : kFeaturePlanes;
}

/// How many planes the results of a scene with these FEATURE_* bits have: the same with the coverage behind
/// them.
constexpr int plane_count(std::uint64_t features) {
  return layer_planes_end(features) + ((features & FEATURE_COVERAGE) != 0 ? 1 : 0);
}

/// Of images of so many planes, the one that is the share of the samples which met something, or a sky that
/// is seen: alpha. -1: there is none.
constexpr int coverage_plane_of(int image_planes) {
  for (const int end : {int(kRadiancePlanes), int(kFeaturePlanes), int(kSampleBufferPlanes)})
    if (image_planes == end + 1) return end;
  return -1;
}
/// How many of SampleBufferPlane they have.
constexpr int layer_planes_of(int image_planes) {
  return coverage_plane_of(image_planes) < 0 ? image_planes : image_planes - 1;
}

/// How many planes a device writes for so many samples of a pixel: those, and pairs of mattes
/// (FEATURE_MATTES), which take_mattes takes out of them.
inline int device_plane_count(std::uint64_t features, std::uint32_t sample_count) {
  return plane_count(features) + ((features & FEATURE_MATTES) != 0 ? 2 * matte_pairs(int(sample_count)) : 0);
}

/// Statistics of `sample_count` samples for each pixel of a rectangle. Plane p of pixel (x, y), counted from
/// the rectangle's corner, is `values[(p * height + y) * width + x]`. A pure function of scene, seed, pixel
/// and the range of sample indices: the same bytes from any worker. All values are finite: samples that are
/// not are counted and left out by the device, see block_accumulate.h.
struct SampleBuffer {
  int width = 0;
  int height = 0;
  int planes = kRadiancePlanes;
  std::uint32_t sample_count = 0;
  FlaggedKinds flagged = {};  ///< samples with a NaN channel, with an infinite one (and no NaN), and others
  std::vector<float> values;
  /// With FEATURE_MATTES, of one pixel after the other: how many pairs, then those, a matte and how many of
  /// the samples met it, at least one. Mattes ascend, from NO_MATTE on; the counts are those of all samples.
  std::vector<std::uint32_t> mattes = {};

  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  [[nodiscard]] std::span<const float> plane(int p) const {
    return std::span(values).subspan(std::size_t(p) * pixels(), pixels());
  }
  [[nodiscard]] std::span<float> plane(int p) {
    return std::span(values).subspan(std::size_t(p) * pixels(), pixels());
  }
};

/// Whether the values are statistics at all: every one finite, no deviation below 0. What goes into a film
/// from outside has been through this.
Expected<void> check_statistics(const SampleBuffer& buffer);

/// What results of a scene look like.
struct ResultShape {
  int planes = kRadiancePlanes;
  int matte_count = 0;
};

/// Makes `mattes` of the planes that a device has written for them, behind the others, which remain.
void take_mattes(SampleBuffer& buffer);

/// Whether `mattes` is what it should be, of a scene with so many of them; with 0, nothing.
Expected<void> check_mattes(const SampleBuffer& buffer, int matte_count);

}  // namespace penumbra
