// What a worker returns for one work unit: per-pixel statistics of the unit's samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "kernels/film_layers.h"
#include "kernels/host/error.h"
#include "kernels/host/flagged_samples.h"
#include "kernels/unit.h"

namespace penumbra {

/// The first planes of a result, one float per pixel each; those of the layers follow
/// (kernels/film_layers.h).
enum SampleBufferPlane : int {
  kMeanR,
  kMeanG,
  kMeanB,  ///< mean radiance over the unit's samples, linear Rec. 709
  kDeviationR,
  kDeviationG,
  kDeviationB,  ///< standard deviation, sqrt(mean (sample - mean)^2): its square may be more than a float
                ///< holds
  kRadiancePlanes
};
static_assert(kRadiancePlanes == RADIANCE_PLANES);

/// The layers and mattes that results of a scene have, and films of them.
class FilmLayers {
 public:
  constexpr FilmLayers() = default;  ///< none
  /// Of a scene with these FEATURE_* bits, and so many mattes.
  constexpr explicit FilmLayers(std::uint64_t features, int mattes = 0)
      : features_(features), mattes_(mattes) {}

  [[nodiscard]] constexpr bool has(int layer) const { return has_layer(features_, layer); }
  [[nodiscard]] constexpr int mattes() const { return mattes_; }
  /// The first plane of a layer that is there.
  [[nodiscard]] constexpr int plane(int layer) const { return layer_plane(features_, layer); }
  /// How many planes there are, those of radiance among them.
  [[nodiscard]] constexpr int planes() const { return plane(FILM_LAYERS); }

 private:
  std::uint64_t features_ = 0;
  int mattes_ = 0;
};

/// How a layer is called, and how many planes it has.
struct FilmLayerInfo {
  std::string_view name;      ///< of its channels in an image, before a dot; may be empty
  std::string_view channels;  ///< a letter each; none where it is not shown by itself
  int planes;
};
#define LAYER_INFO(NAME, planes, needs, samples, mean, layer, channels) \
  FilmLayerInfo{layer, channels, planes},
inline constexpr FilmLayerInfo kFilmLayers[] = {PENUMBRA_FILM_LAYERS(LAYER_INFO)};
#undef LAYER_INFO

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
  FlaggedByKind flagged = {};  ///< samples with a NaN channel, with an infinite one (and no NaN), and others
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

/// Makes `mattes` of the planes that a device has written for them, behind the others, which remain.
void take_mattes(SampleBuffer& buffer);

/// Whether `mattes` is what it should be, of a scene with so many of them; with 0, nothing.
Expected<void> check_mattes(const SampleBuffer& buffer, int matte_count);

}  // namespace penumbra
