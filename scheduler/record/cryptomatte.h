// Cryptomatte: the IDs of the objects and materials visible in each pixel with their coverage, as image
// layers from which compositing programs extract mattes by name. Psyop, "Cryptomatte Specification", version
// 1.2.0.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/matte_names.h"
#include "scheduler/image/image.h"
#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// A. Appleby, MurmurHash3_x86_32 (2011).
std::uint32_t murmur_hash3_32(std::string_view bytes, std::uint32_t seed = 0);

/// The hash of a name, adjusted so that its bits as a float are neither NaN nor infinite nor denormal: if the
/// exponent is all zeros or all ones, its lowest bit is flipped.
std::uint32_t cryptomatte_hash(std::string_view name);

/// The layers CryptoObject and CryptoMaterial have three groups of R, G, B, A each, which hold six ranks. A
/// rank is an ID (the hash as a float) and its coverage. Coverage decreases from rank to rank; missing ranks
/// are 0. Coverage is the fraction of the pixel's samples whose camera ray hits the name first. The rest to 1
/// hit nothing, or belongs to further names.
constexpr int kCryptomatteRanks = 6;
std::vector<std::string> cryptomatte_channels();
/// The number of channels of both layers.
constexpr int kCryptomatteChannels = 2 * 2 * kCryptomatteRanks;

/// The metadata `cryptomatte/…` of both layers. A manifest is JSON that maps each name to its hash as 8
/// hexadecimal digits.
std::vector<std::pair<std::string, MetadataValue>> cryptomatte_metadata(const MatteNames& names);

/// Computes the values of those channels, pixel by pixel.
class CryptomattePixels {
 public:
  explicit CryptomattePixels(const MatteNames& names);
  /// Appends the values of the pixel.
  void append(const FilmAccumulator& film, int x, int y, std::vector<float>& values);

 private:
  struct Rank {
    std::uint32_t hash;
    double weight;  // see MatteWeight
  };
  void append_layer(double samples, std::vector<float>& values);

  const MatteNames& names_;
  std::vector<std::uint32_t> objects_, materials_;  // hashes of the names
  std::vector<Rank> ranks_;                         // of the current pixel; the memory is reused
};

}  // namespace penumbra
