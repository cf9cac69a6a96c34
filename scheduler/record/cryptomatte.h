// Cryptomatte: who is seen in each pixel and how much of it he covers, as layers of an image from which
// compositing programs make mattes by name. Psyop, "Cryptomatte Specification", version 1.2.0.
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

/// The hash of a name whose bits as a float are neither NaN nor infinite nor denormal: an exponent of all
/// zeros or all ones has its lowest bit flipped.
std::uint32_t cryptomatte_hash(std::string_view name);

/// The layers CryptoObject and CryptoMaterial, three groups of R, G, B, A each: six ranks of an id, the hash
/// as a float, and its coverage, which falls from rank to rank; 0 where there are fewer. Coverage is the
/// share of the pixel's samples that met somebody of that name first; what is missing to 1 met nobody, or is
/// of lower ranks.
constexpr int kCryptomatteRanks = 6;
std::vector<std::string> cryptomatte_channels();
/// How many those are.
constexpr int kCryptomatteChannels = 2 * 2 * kCryptomatteRanks;

/// `cryptomatte/…` of both layers. A manifest is JSON: of each name its hash as 8 hexadecimal digits.
std::vector<std::pair<std::string, MetadataValue>> cryptomatte_metadata(const MatteNames& names);

/// The values of those channels, pixel by pixel.
class CryptomattePixels {
 public:
  explicit CryptomattePixels(const MatteNames& names);
  /// Appends the pixel's.
  void append(const FilmAccumulator& film, int x, int y, std::vector<float>& values);

 private:
  struct Rank {
    std::uint32_t hash;
    double weight;  // see MatteWeight
  };
  void append_layer(double samples, std::vector<float>& values);

  const MatteNames& names_;
  std::vector<std::uint32_t> objects_, materials_;  // hashes of the names
  std::vector<Rank> ranks_;                         // of one pixel, in memory that is used again
};

}  // namespace penumbra
