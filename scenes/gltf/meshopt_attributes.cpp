#include "scenes/gltf/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace penumbra::gltf {
namespace {

constexpr std::size_t kGroup = 16;  ///< number of elements whose deltas have the same encoding
constexpr std::size_t kMostBlock = 256, kMostBlockBytes = 8192;
constexpr std::size_t kShortestTail = 24;
constexpr char kHeader = char(0xa1);

/// How the deltas of one byte of all elements are encoded.
enum class Control { kFewBits, kMoreBits, kZero, kLiteral };
/// The type of the deltas of four bytes.
enum class Channel { kBytes, kShorts, kWords };

std::unexpected<Error> damaged() { return fail("meshopt: the compressed data are damaged"); }

template <typename T>
T from_zigzag(T v) {
  return T((v & 1) != 0 ? ~(v >> 1) : v >> 1);
}

class Stream {
 public:
  explicit Stream(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  /// The next `count` bytes; fewer at the end.
  std::string_view take(std::size_t count) {
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(taken.size());
    return taken;
  }

 private:
  std::string_view bytes_;
};

/// Reads sixteen deltas of `bits` bits. One with all bits set means that the value follows as a byte.
bool read_group(Stream& stream, int bits, std::uint8_t* deltas) {
  if (bits == 0) {
    std::fill_n(deltas, kGroup, std::uint8_t(0));
    return true;
  }
  const std::string_view packed = stream.take(kGroup * std::size_t(bits) / 8);
  if (packed.size() < kGroup * std::size_t(bits) / 8) return false;
  const std::size_t per_byte = 8 / std::size_t(bits);
  const unsigned all = (1u << bits) - 1;
  for (std::size_t i = 0; i < kGroup; ++i) {
    const std::size_t place = i % per_byte;
    // From the highest bits down, except single bits, which start at the lowest.
    const std::size_t shift = bits == 1 ? place : (per_byte - 1 - place) * std::size_t(bits);
    const unsigned value = std::uint8_t(packed[i / per_byte]) >> shift & all;
    deltas[i] = std::uint8_t(value);
    if (bits == 8 || value != all) continue;
    const std::string_view byte = stream.take(1);
    if (byte.empty()) return false;
    deltas[i] = std::uint8_t(byte[0]);
  }
  return true;
}

/// Reads the deltas of one byte of a block's elements.
bool read_deltas(Stream& stream, Control control, std::size_t count, std::vector<std::uint8_t>& deltas) {
  const std::size_t groups = (count + kGroup - 1) / kGroup;
  deltas.assign(groups * kGroup, 0);
  if (control == Control::kZero) return true;
  if (control == Control::kLiteral) {
    const std::string_view bytes = stream.take(count);
    std::memcpy(deltas.data(), bytes.data(), bytes.size());
    return bytes.size() == count;
  }
  const std::string_view header = stream.take((groups + 3) / 4);
  if (header.size() < (groups + 3) / 4) return false;
  constexpr std::array<std::array<int, 4>, 2> kBits = {{{0, 1, 2, 4}, {1, 2, 4, 8}}};
  for (std::size_t g = 0; g < groups; ++g) {
    const unsigned mode = std::uint8_t(header[g / 4]) >> (g % 4 * 2) & 3u;
    if (!read_group(stream, kBits[std::size_t(control)][mode], &deltas[g * kGroup])) return false;
  }
  return true;
}

/// Computes four bytes of an element from those of the previous one.
std::uint32_t next_word(std::uint32_t previous, std::uint32_t delta, Channel channel, int rotation) {
  std::uint32_t word = 0;
  switch (channel) {
    case Channel::kBytes:
      for (int shift = 0; shift < 32; shift += 8)
        word |= std::uint32_t(
                    std::uint8_t(std::uint8_t(previous >> shift) + from_zigzag(std::uint8_t(delta >> shift))))
                << shift;
      return word;
    case Channel::kShorts:
      for (int shift = 0; shift < 32; shift += 16)
        word |= std::uint32_t(std::uint16_t(std::uint16_t(previous >> shift) +
                                            from_zigzag(std::uint16_t(delta >> shift))))
                << shift;
      return word;
    case Channel::kWords:
      return previous ^ std::rotr(delta, rotation);
  }
  return word;
}

template <typename Unsigned, typename Signed>
void unfilter_colour(char* element) {
  std::array<Unsigned, 4> in;
  std::memcpy(in.data(), element, sizeof(in));
  // The highest set bit of alpha tells the number of bits.
  const int all = (1 << std::bit_width(unsigned(in[3]))) - 1;
  const int y = in[0], co = Signed(in[1]), cg = Signed(in[2]), half = in[3] & (all >> 1);
  const int rgba[] = {y + co - cg, y + cg, y - co - cg, half << 1 | (half & 1)};
  constexpr float kMost = Unsigned(~Unsigned(0));
  const float scale = all > 0 ? kMost / float(all) : 0.0f;
  for (std::size_t c = 0; c < 4; ++c)
    in[c] = Unsigned(std::lround(std::clamp(float(rgba[c]) * scale, 0.0f, kMost)));
  std::memcpy(element, in.data(), sizeof(in));
}

}  // namespace

bool is_attributes_1(std::string_view bytes) { return !bytes.empty() && bytes[0] == kHeader; }

Expected<std::string> read_attributes_1(std::string_view bytes, std::size_t count, std::size_t stride) {
  const std::size_t channels = stride / 4, tail = std::max(stride + channels, kShortestTail);
  if (!is_attributes_1(bytes) || bytes.size() < 1 + tail) return damaged();
  const std::string_view end = bytes.substr(bytes.size() - (stride + channels));
  Stream stream(bytes.substr(1, bytes.size() - 1 - tail));
  std::vector<std::uint32_t> last(channels);
  std::memcpy(last.data(), end.data(), stride);
  const std::string_view modes = end.substr(stride);
  for (const char mode : modes)
    if ((mode & 15) > 2 || ((mode & 15) < 2 && (mode & 0xf0) != 0)) return damaged();

  std::string elements(count * stride, '\0');
  const std::size_t most = std::min(kMostBlockBytes / stride / kGroup * kGroup, kMostBlock);
  std::array<std::vector<std::uint8_t>, 4> deltas;
  for (std::size_t first = 0; first < count; first += most) {
    const std::size_t block = std::min(most, count - first);
    const std::string_view controls = stream.take(channels);
    if (controls.size() < channels) return damaged();
    for (std::size_t k = 0; k < channels; ++k) {
      for (std::size_t j = 0; j < 4; ++j)
        if (!read_deltas(stream, Control(std::uint8_t(controls[k]) >> (2 * j) & 3u), block, deltas[j]))
          return damaged();
      const auto mode = std::uint8_t(modes[k]);
      for (std::size_t i = 0; i < block; ++i) {
        std::uint32_t delta = 0;
        for (std::size_t j = 0; j < 4; ++j) delta |= std::uint32_t(deltas[j][i]) << (8 * j);
        last[k] = next_word(last[k], delta, Channel(mode & 15), mode >> 4);
        std::memcpy(&elements[(first + i) * stride + 4 * k], &last[k], 4);
      }
    }
  }
  if (!stream.at_end()) return damaged();
  return elements;
}

void unfilter_colours(std::span<char> elements, std::size_t stride) {
  for (std::size_t at = 0; at + stride <= elements.size(); at += stride) {
    if (stride == 4) unfilter_colour<std::uint8_t, std::int8_t>(&elements[at]);
    if (stride == 8) unfilter_colour<std::uint16_t, std::int16_t>(&elements[at]);
  }
}

}  // namespace penumbra::gltf
