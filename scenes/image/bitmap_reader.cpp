#include "scenes/image/bitmap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <sstream>
#include <vector>

#include "kernels/host/limited_child.h"
#include "kernels/host/module.h"
#include "scenes/diagnostic.h"
#include "scenes/image/colour_channels.h"
#include "scenes/image/common_formats.h"
#include "scenes/image/exr_file.h"
#include "scenes/image/image_module.h"
#include "scenes/image/image_room.h"
#include "scenes/image/radiance_file.h"

namespace penumbra {
namespace {

using Names = std::vector<std::string>;

/// The image's channels that become the bitmap's. Empty if the image's channels are not those of a texture.
std::vector<std::size_t> chosen(const Names& names, BitmapChannels channels) {
  if (channels != BitmapChannels::kAll) {
    const char name = channels == BitmapChannels::kRed     ? 'R'
                      : channels == BitmapChannels::kGreen ? 'G'
                      : channels == BitmapChannels::kBlue  ? 'B'
                                                           : 'A';
    const auto at = index_of_colour(names, name);
    // A grey channel is used as red, green and blue.
    const auto grey = channels == BitmapChannels::kAlpha ? std::nullopt : index_of_colour(names, 'Y');
    if (!at && !grey) return {};
    return {at ? *at : *grey};
  }
  if (names.size() == 1) return {0};
  // Other layers are ignored.
  const auto r = index_of_colour(names, 'R'), g = index_of_colour(names, 'G'),
             b = index_of_colour(names, 'B');
  if (r && g && b) return {*r, *g, *b};
  if (const auto y = index_of_colour(names, 'Y')) return {*y};
  return {};
}

// Fast tests on the bits of numbers: whether they are finite, and whether they are in [0, 1].
bool is_finite(std::uint16_t half) { return (half & 0x7c00u) != 0x7c00u; }
bool is_in_unit(std::uint16_t half) { return half <= 0x3c00u || half == 0x8000u; }
bool is_finite(float value) { return std::isfinite(value); }
bool is_in_unit(float value) { return value >= 0.0f && value <= 1.0f; }

/// Replaces values that are not finite by 0.
template <typename Value>
void check_values(std::span<std::uint32_t> words, std::size_t count, int width, int channels,
                  BitmapFindings& findings) {
  auto* bytes = reinterpret_cast<std::byte*>(words.data());
  for (std::size_t i = 0; i < count; ++i) {
    Value value;
    std::memcpy(&value, bytes + i * sizeof(Value), sizeof(Value));
    if (is_finite(value)) {
      findings.outside_unit += is_in_unit(value) ? 0 : 1;
      continue;
    }
    const std::size_t texel = i / std::size_t(channels);
    if (findings.not_finite++ == 0) {
      findings.first_x = int(texel % std::size_t(width));
      findings.first_y = int(texel / std::size_t(width));
    }
    std::memset(bytes + i * sizeof(Value), 0, sizeof(Value));
  }
}

/// Copies these channels of all texels, of `Size` bytes each.
template <std::size_t Size>
void copy_channels(const ImageContents& image, std::span<const std::size_t> from, std::byte* to) {
  const std::size_t texels = std::size_t(image.width) * std::size_t(image.height);
  const std::byte* texel = image.bytes.data();
  for (std::size_t i = 0; i < texels; ++i, texel += image.channels.size() * Size)
    for (const std::size_t channel : from) {
      std::memcpy(to, texel + channel * Size, Size);
      to += Size;
    }
}

/// Converts a bitmap of three floats per texel from linear colours of other primaries to Rec. 709.
void convert_primaries(const ColorMatrix& matrix, Bitmap& bitmap) {
  for (std::size_t i = 0; i + 2 < bitmap.words.size(); i += 3) {
    const auto at = [&](std::size_t k) { return double(std::bit_cast<float>(bitmap.words[i + k])); };
    const Color converted = transformed(matrix, {at(0), at(1), at(2)});
    for (std::size_t k = 0; k < 3; ++k)
      bitmap.words[i + k] = std::bit_cast<std::uint32_t>(float(converted[k]));
  }
}

/// What precedes the texels when they come from another process.
struct ImageHeader {
  std::int32_t width = 0, height = 0, type = 0, has_chromaticities = 0;
  Chromaticities chromaticities{};
  std::uint64_t name_bytes = 0;  ///< of the names of the channels that follow, each with a line end
};

Expected<void> write_image(const ImageContents& image, const ChildOutput& output) {
  ImageHeader header{image.width, image.height, int(image.type), image.chromaticities ? 1 : 0};
  header.chromaticities = image.chromaticities.value_or(Chromaticities());
  std::string names;
  for (const std::string& channel : image.channels) names += channel + '\n';
  header.name_bytes = names.size();
  const auto write = [&](const void* bytes, std::size_t size) {
    return output({static_cast<const std::uint8_t*>(bytes), size});
  };
  if (!write(&header, sizeof header) || !write(names.data(), names.size()) ||
      !write(image.bytes.data(), image.bytes.size()))
    return fail("nobody reads it");
  return {};
}

/// What write_image wrote. The process that did may not have been sound.
Expected<ImageContents> take_image(const ChildInput& input) {
  constexpr std::uint64_t kMostNames = 1 << 20;
  const auto damaged = [] { return fail("cannot be read as an image: it is damaged"); };
  const auto read = [&](void* bytes, std::size_t size) {
    return input({static_cast<std::uint8_t*>(bytes), size});
  };
  ImageHeader header;
  if (!read(&header, sizeof header) || header.width < 1 || header.height < 1 || header.type < 0 ||
      header.type > int(TexelType::kFloat) || header.name_bytes > kMostNames)
    return damaged();
  std::string names(header.name_bytes, ' ');
  if (!read(names.data(), names.size())) return damaged();
  ImageContents image;
  image.width = header.width;
  image.height = header.height;
  image.type = TexelType(header.type);
  if (header.has_chromaticities != 0) image.chromaticities = header.chromaticities;
  std::istringstream lines(names);
  for (std::string name; std::getline(lines, name);) image.channels.push_back(name);
  if (image.channels.empty()) return damaged();
  if (auto room = make_room(image, kMaxBitmapBytes); !room) return std::unexpected(room.error());
  if (!read(image.bytes.data(), image.bytes.size())) return damaged();
  return image;
}

/// What reading may take: the texels, what libraries need beside them, and a time that only what never ends
/// exceeds.
ChildLimits limits_of(std::string_view contents) {
  return {.memory_bytes = 2 * kMaxBitmapBytes + 4 * contents.size(),
          .cpu_seconds = unsigned(10 + 4 * (contents.size() >> 20))};
}

/// In a process of its own: some of OpenImageIO's formats crash on damaged files, or never end.
Expected<ImageContents> read_by_module(const TexelReader& reader, const std::string& name,
                                       std::string_view contents) {
  Expected<ImageContents> image = ImageContents();
  const Expected<void> done = run_limited(
      limits_of(contents),
      [&](const ChildOutput& output) -> Expected<void> {
        const auto read = reader.read(name, contents, kMaxBitmapBytes);
        return read ? write_image(*read, output) : std::unexpected(read.error());
      },
      [&](const ChildInput& input) -> Expected<void> {
        image = take_image(input);
        if (!image) return std::unexpected(image.error());
        return {};
      });
  if (!done) return std::unexpected(done.error());
  return image;
}

Expected<ImageContents> contents_of(const std::string& name, std::string_view contents) {
  if (is_exr(contents)) return read_exr(contents, kMaxBitmapBytes);
  if (is_radiance(contents)) return read_radiance(contents, kMaxBitmapBytes);
  if (std::optional<ImageContents> common = read_common_image(contents, kMaxBitmapBytes))
    return std::move(*common);
  static const Expected<const void*> reader =
      load_module("libpenumbra_image_reader.so", "penumbra_texel_reader");
  if (!reader)
    return fail(
        fmt::format("cannot be read, because what reads images does not load: {}", reader.error().message));
  return read_by_module(*static_cast<const TexelReader*>(*reader), name, contents);
}

}  // namespace

std::vector<std::string> describe(const BitmapFindings& findings, const std::string& name, bool reflects) {
  std::vector<std::string> result;
  if (findings.not_finite > 0) {
    const bool one = findings.not_finite == 1;
    result.push_back(fmt::format("'{}' has {} {} not finite, the first at texel ({}, {}); 0 stands in for {}",
                                 name, findings.not_finite, one ? "value that is" : "values that are",
                                 findings.first_x, findings.first_y, one ? "it" : "them"));
  }
  if (findings.outside_unit > 0 && reflects) {
    result.push_back(fmt::format(
        "'{}' has {} outside [0, 1]; a reflectance above 1 gives off more light than "
        "it receives",
        name, findings.outside_unit == 1 ? "1 value" : fmt::format("{} values", findings.outside_unit)));
  }
  return result;
}

Expected<Bitmap> read_bitmap(const std::string& name, std::string_view contents, BitmapChannels channels,
                             BitmapFindings& findings) {
  static_assert(std::endian::native == std::endian::little, "words are packed lowest byte first");
  const Expected<ImageContents> image = contents_of(name, contents);
  if (!image) return fail(fmt::format("'{}' {}", name, image.error().message));
  const std::vector<std::size_t> from = chosen(image->channels, channels);
  if (from.empty()) {
    if (channels == BitmapChannels::kAll)
      return fail(fmt::format("'{}' {}", name, no_colours_text(image->channels)));
    return fail(fmt::format("'{}' has {} channels ({}); the one that is asked for is not there", name,
                            image->channels.size(), list_names(image->channels)));
  }
  const std::optional<ColorMatrix> matrix =
      image->chromaticities ? rec709_from_rgb(*image->chromaticities) : std::nullopt;
  if (image->chromaticities && !matrix)
    return fail(fmt::format("'{}' has chromaticities that define no colours", name));
  Bitmap bitmap;
  bitmap.name = name;
  bitmap.width = image->width;
  bitmap.height = image->height;
  bitmap.channels = int(from.size());
  bitmap.type = image->type;
  const std::size_t size = size_of(image->type),
                    values = std::size_t(image->width) * std::size_t(image->height) * from.size();
  bitmap.words.resize((values * size + 3) / 4);
  auto* to = reinterpret_cast<std::byte*>(bitmap.words.data());
  if (size == 1) copy_channels<1>(*image, from, to);
  if (size == 2) copy_channels<2>(*image, from, to);
  if (size == 4) copy_channels<4>(*image, from, to);
  if (bitmap.type == TexelType::kHalf)
    check_values<std::uint16_t>(bitmap.words, values, bitmap.width, bitmap.channels, findings);
  if (bitmap.type == TexelType::kFloat)
    check_values<float>(bitmap.words, values, bitmap.width, bitmap.channels, findings);
  if (matrix && bitmap.channels == 3) convert_primaries(*matrix, bitmap);
  return bitmap;
}

}  // namespace penumbra
