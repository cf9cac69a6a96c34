#include "scenes/image/radiance_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "scenes/image/image_room.h"

namespace penumbra {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

std::unexpected<Error> damaged(const std::string& why) { return fail("cannot be read as an image: " + why); }

/// The next line without its end. Nothing: the file ends before.
std::optional<std::string_view> take_line(std::string_view& left) {
  const std::size_t end = left.find('\n');
  if (end == left.npos) return std::nullopt;
  std::string_view line = left.substr(0, end);
  left.remove_prefix(end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// One axis of a resolution line: "-Y 4".
struct Axis {
  char name = 0;
  bool falls = false;
  int size = 0;
};

/// How scanlines lie: along the second axis, one after the other along the first.
struct Resolution {
  Axis lines, along;
};

std::optional<Axis> take_axis(std::string_view& text) {
  if (text.size() < 3 || (text[0] != '+' && text[0] != '-') || (text[1] != 'X' && text[1] != 'Y'))
    return std::nullopt;
  Axis axis{.name = text[1], .falls = text[0] == '-'};
  text.remove_prefix(2);
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), axis.size);
  if (error != std::errc() || axis.size <= 0) return std::nullopt;
  text.remove_prefix(std::size_t(end - text.data()));
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return axis;
}

std::optional<Resolution> resolution_of(std::string_view line) {
  const auto lines = take_axis(line);
  const auto along = lines ? take_axis(line) : std::nullopt;
  if (!along || !line.empty() || lines->name == along->name) return std::nullopt;
  return Resolution{*lines, *along};
}

/// Runs of whole texels: 1, 1, 1, n repeats the last texel n times, and a further one in a row n * 256 times.
bool read_old_scanline(std::string_view& left, std::vector<Rgbe>& line) {
  std::size_t at = 0;
  int shift = 0;
  while (at < line.size()) {
    Rgbe texel;
    if (left.size() < texel.size()) return false;
    std::memcpy(texel.data(), left.data(), texel.size());
    left.remove_prefix(texel.size());
    if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
      line[at++] = texel;
      shift = 0;
      continue;
    }
    const std::size_t count = shift > 24 ? line.size() : std::size_t(texel[3]) << shift;
    if (at == 0 || count > line.size() - at) return false;
    std::fill_n(line.begin() + std::ptrdiff_t(at), count, line[at - 1]);
    at += count;
    shift += 8;
  }
  return true;
}

/// Runs of bytes, one component after the other: n > 128 repeats the next byte n - 128 times, others precede
/// n bytes.
bool read_components(std::string_view& left, std::vector<Rgbe>& line) {
  for (std::size_t component = 0; component < 4; ++component)
    for (std::size_t at = 0; at < line.size();) {
      if (left.size() < 2) return false;
      const auto code = std::uint8_t(left[0]);
      const bool repeats = code > 128;
      const std::size_t count = repeats ? code - 128u : code, bytes = repeats ? 1 : count;
      left.remove_prefix(1);
      if (count == 0 || count > line.size() - at || bytes > left.size()) return false;
      for (std::size_t i = 0; i < count; ++i) line[at++][component] = std::uint8_t(left[repeats ? 0 : i]);
      left.remove_prefix(bytes);
    }
  return true;
}

bool read_scanline(std::string_view& left, std::vector<Rgbe>& line) {
  constexpr std::size_t kLeast = 8, kMost = 0x7fff;  // lengths that the newer code is for
  if (line.size() < kLeast || line.size() > kMost || left.size() < 4 || left[0] != 2 || left[1] != 2 ||
      (std::uint8_t(left[2]) & 0x80) != 0)
    return read_old_scanline(left, line);
  if (std::size_t(std::uint8_t(left[2])) * 256 + std::uint8_t(left[3]) != line.size()) return false;
  left.remove_prefix(4);
  return read_components(left, line);
}

void append(const std::vector<Rgbe>& line, std::vector<std::byte>& bytes) {
  static const std::array<float, 256> scales = [] {
    std::array<float, 256> powers{};
    for (std::size_t e = 1; e < powers.size(); ++e) powers[e] = std::ldexp(1.0f, int(e) - (128 + 8));
    return powers;
  }();
  const std::size_t before = bytes.size();
  bytes.resize(before + line.size() * 3 * sizeof(float));
  std::byte* to = bytes.data() + before;
  for (const Rgbe& texel : line)
    for (std::size_t c = 0; c < 3; ++c, to += sizeof(float)) {
      const float value = float(texel[c]) * scales[texel[3]];
      std::memcpy(to, &value, sizeof value);
    }
}

/// The texels of scanlines that lie in another way than rows from the top.
std::vector<std::byte> upright(const std::vector<std::byte>& bytes, const Resolution& resolution, int width,
                               int height) {
  constexpr std::size_t kTexel = 3 * sizeof(float);
  std::vector<std::byte> result(bytes.size());
  const std::byte* from = bytes.data();
  const auto place = [](const Axis& axis, int i) { return axis.falls ? axis.size - 1 - i : i; };
  for (int i = 0; i < resolution.lines.size; ++i)
    for (int k = 0; k < resolution.along.size; ++k, from += kTexel) {
      const bool rows = resolution.lines.name == 'Y';
      const int x = rows ? place(resolution.along, k) : place(resolution.lines, i);
      const int up = rows ? place(resolution.lines, i) : place(resolution.along, k);
      const auto at = std::size_t(height - 1 - up) * std::size_t(width) + std::size_t(x);
      std::memcpy(result.data() + at * kTexel, from, kTexel);
    }
  return result;
}

Expected<Resolution> read_header(std::string_view& left) {
  std::string format;
  for (;;) {
    const auto line = take_line(left);
    if (!line) return damaged("the file ends within its header");
    if (line->empty()) break;
    if (line->starts_with("FORMAT=")) format = line->substr(7);
  }
  if (format != "32-bit_rle_rgbe")
    return damaged(fmt::format("its FORMAT is '{}'; 32-bit_rle_rgbe is read", format));
  const auto line = take_line(left);
  const auto resolution = line ? resolution_of(*line) : std::nullopt;
  if (!resolution)
    return damaged(
        fmt::format("its resolution line is '{}'; one such as '-Y 512 +X 1024' is right", line.value_or("")));
  return *resolution;
}

}  // namespace

bool is_radiance(std::string_view contents) { return contents.starts_with("#?"); }

Expected<ImageContents> read_radiance(std::string_view contents, std::size_t most_bytes) {
  std::string_view left = contents;
  const auto resolution = read_header(left);
  if (!resolution) return std::unexpected(resolution.error());
  const auto& [lines, along] = *resolution;
  ImageContents image;
  image.width = lines.name == 'X' ? lines.size : along.size;
  image.height = lines.name == 'X' ? along.size : lines.size;
  image.channels = {"R", "G", "B"};
  image.type = TexelType::kFloat;
  if (auto checked = check_room(image, most_bytes); !checked) return std::unexpected(checked.error());
  try {
    // A file that ends early needs no more memory than its texels do.
    image.bytes.reserve(std::size_t(image.width) * std::size_t(image.height) * 3 * sizeof(float));
    std::vector<Rgbe> line(std::size_t(along.size));
    for (int i = 0; i < lines.size; ++i) {
      if (!read_scanline(left, line))
        return damaged(fmt::format("its scanline {} of {} is incomplete or damaged", i + 1, lines.size));
      append(line, image.bytes);
    }
    if (lines.name != 'Y' || !lines.falls || along.falls)
      image.bytes = upright(image.bytes, *resolution, image.width, image.height);
  } catch (const std::bad_alloc&) {
    return fail("has more pixels than there is memory for");
  }
  return image;
}

}  // namespace penumbra
