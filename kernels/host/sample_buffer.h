// The result of a work unit: per-pixel statistics of its samples.
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

/// The first planes of a result, one float per pixel each. Those of the layers follow
/// (kernels/film_layers.h).
enum SampleBufferPlane : int {
  kMeanR,
  kMeanG,
  kMeanB,  ///< mean radiance over the unit's samples, linear Rec. 709
  kDeviationR,
  kDeviationG,
  kDeviationB,  ///< standard deviation, sqrt(mean (sample - mean)^2); the variance may overflow a float
  kRadiancePlanes
};
static_assert(kRadiancePlanes == RADIANCE_PLANES);

/// The layers and mattes of a scene's results and films.
class FilmLayers {
 public:
  constexpr FilmLayers() : FilmLayers(0) {}  ///< none
  /// For a scene with these FEATURE_* bits and this number of mattes.
  constexpr explicit FilmLayers(std::uint64_t features, int mattes = 0) : mattes_(mattes) {
    for (int layer = 0; layer <= FILM_LAYERS; ++layer) first_plane_[layer] = layer_plane(features, layer);
  }

  [[nodiscard]] constexpr bool has(int layer) const { return first_plane_[layer + 1] > first_plane_[layer]; }
  [[nodiscard]] constexpr int mattes() const { return mattes_; }
  /// The first plane of a layer; the layer must exist.
  [[nodiscard]] constexpr int plane(int layer) const { return first_plane_[layer]; }
  /// The number of planes, including those of radiance.
  [[nodiscard]] constexpr int planes() const { return plane(FILM_LAYERS); }

 private:
  int first_plane_[FILM_LAYERS + 1] = {};  // of each layer; the last is the number of planes
  int mattes_ = 0;
};

/// Name and number of planes of a layer.
struct FilmLayerInfo {
  std::string_view name;      ///< prefix of its channel names in an image, before a dot; may be empty
  std::string_view channels;  ///< a letter for each plane, or the name of the only one; empty: not shown
  int planes;

  /// The number of channels in an image; 0 if the layer is not shown by itself.
  [[nodiscard]] constexpr int shown() const { return channels.empty() ? 0 : planes; }
  /// The name of one of them without the prefix.
  [[nodiscard]] constexpr std::string_view channel(int plane) const {
    return planes == 1 ? channels : channels.substr(std::size_t(plane), 1);
  }
};
#define LAYER_INFO(NAME, planes, needs, samples, mean, layer, channels) \
  FilmLayerInfo{layer, channels, planes},
inline constexpr FilmLayerInfo kFilmLayers[] = {PENUMBRA_FILM_LAYERS(LAYER_INFO)};
#undef LAYER_INFO

/// The number of planes that a device writes for `sample_count` samples per pixel, including the pairs of
/// planes for mattes (FEATURE_MATTES), which take_mattes removes.
inline int device_plane_count(std::uint64_t features, std::uint32_t sample_count) {
  return plane_count(features) + ((features & FEATURE_MATTES) != 0 ? 2 * matte_pairs(int(sample_count)) : 0);
}

/// Statistics of `sample_count` samples for each pixel of a rectangle. Plane p of pixel (x, y), relative to
/// the rectangle's corner, is `values[(p * height + y) * width + x]`. It is a pure function of scene, seed,
/// pixel and the range of sample indices: every worker returns the same bytes. All values are finite: the
/// device counts non-finite samples and leaves them out, see block_accumulate.h.
struct SampleBuffer {
  int width = 0;
  int height = 0;
  int planes = kRadiancePlanes;
  std::uint32_t sample_count = 0;
  FlaggedByKind flagged = {};  ///< bad samples by kind, BAD_*
  std::vector<float> values;
  /// With FEATURE_MATTES, for each pixel: the number of pairs, then the pairs: a matte number and how many
  /// samples hit it, at least one. Matte numbers ascend from NO_MATTE on; the counts of a pixel add up to its
  /// samples.
  std::vector<std::uint32_t> mattes = {};

  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  [[nodiscard]] std::span<const float> plane(int p) const {
    return std::span(values).subspan(std::size_t(p) * pixels(), pixels());
  }
  [[nodiscard]] std::span<float> plane(int p) {
    return std::span(values).subspan(std::size_t(p) * pixels(), pixels());
  }
};

/// Checks that the values are valid statistics: all finite, no negative deviation. Results from outside must
/// pass this before they go into a film.
Expected<void> check_statistics(const SampleBuffer& buffer);
/// The same for the values [begin, end), which must be there.
Expected<void> check_statistics(const SampleBuffer& buffer, std::size_t begin, std::size_t end);

/// Converts the planes of mattes, which a device has written after the others, to `mattes`. The other planes
/// remain.
void take_mattes(SampleBuffer& buffer);

/// Checks `mattes` for a scene with `matte_count` mattes; for 0 there must be none.
Expected<void> check_mattes(const SampleBuffer& buffer, int matte_count);

}  // namespace penumbra
