#include "scenes/image/bitmap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "kernels/host/module.h"
#include "scenes/diagnostic.h"
#include "scenes/image/image_module.h"

namespace penumbra {
namespace {

using Names = std::vector<std::string>;

std::optional<std::size_t> index_of(const Names& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  return found == names.end() ? std::nullopt : std::optional(std::size_t(found - names.begin()));
}

/// The channels of the image that become the bitmap's; none, where it has others than a texture's.
std::vector<std::size_t> chosen(const Names& names, BitmapChannels channels) {
  if (channels != BitmapChannels::kAll) {
    const char* const name = channels == BitmapChannels::kRed     ? "R"
                             : channels == BitmapChannels::kGreen ? "G"
                             : channels == BitmapChannels::kBlue  ? "B"
                                                                  : "A";
    const auto at = index_of(names, name);
    // A grey image is its red, green and blue.
    const auto grey = channels == BitmapChannels::kAlpha ? std::nullopt : index_of(names, "Y");
    if (!at && !grey) return {};
    return {at ? *at : *grey};
  }
  if (names.size() == 1) return {0};
  const std::size_t others = index_of(names, "A") ? 1 : 0;
  if (const auto y = index_of(names, "Y"); y && names.size() == 1 + others) return {*y};
  const auto r = index_of(names, "R"), g = index_of(names, "G"), b = index_of(names, "B");
  if (r && g && b && names.size() == 3 + others) return {*r, *g, *b};
  return {};
}

/// Sets what is no number to 0.
template <typename Value, typename ToFloat>
void check_values(std::vector<std::byte>& bytes, int width, int channels, ToFloat to_float,
                  BitmapFindings& findings) {
  for (std::size_t i = 0; i < bytes.size() / sizeof(Value); ++i) {
    Value value;
    std::memcpy(&value, bytes.data() + i * sizeof(Value), sizeof(Value));
    const float number = to_float(value);
    if (std::isfinite(number)) {
      findings.outside_unit += number < 0.0f || number > 1.0f ? 1 : 0;
      continue;
    }
    const std::size_t texel = i / std::size_t(channels);
    if (findings.not_finite++ == 0) {
      findings.first_x = int(texel % std::size_t(width));
      findings.first_y = int(texel / std::size_t(width));
    }
    std::memset(bytes.data() + i * sizeof(Value), 0, sizeof(Value));
  }
}

/// Good enough to tell what is finite and within [0, 1].
float half_range(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31;
  if (exponent == 31) return NAN;
  const float size = std::ldexp(float((bits & 1023) | (exponent > 0 ? 1024 : 0)), std::max(exponent, 1) - 25);
  return (bits & 0x8000) != 0 ? -size : size;
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
  static const Expected<const void*> reader =
      load_module("libpenumbra_texel_reader.so", "penumbra_texel_reader");
  if (!reader) return fail(fmt::format("cannot load what reads images: {}", reader.error().message));
  const auto image = static_cast<const TexelReader*>(*reader)->read(name, contents, kMaxBitmapBytes);
  if (!image) return fail(fmt::format("'{}' {}", name, image.error().message));
  const std::vector<std::size_t> from = chosen(image->channels, channels);
  if (from.empty()) {
    return fail(fmt::format(
        "'{}' has {} channels ({}); {}", name, image->channels.size(), list_names(image->channels),
        channels == BitmapChannels::kAll ? "a texture has Y, or R, G and B, each with A or without"
                                         : "the one that is asked for is not there"));
  }
  Bitmap bitmap;
  bitmap.name = name;
  bitmap.width = image->width;
  bitmap.height = image->height;
  bitmap.channels = int(from.size());
  bitmap.type = image->type;
  const std::size_t size = size_of(image->type),
                    texels = std::size_t(image->width) * std::size_t(image->height);
  std::vector<std::byte> bytes(texels * from.size() * size);
  for (std::size_t i = 0; i < texels; ++i)
    for (std::size_t c = 0; c < from.size(); ++c)
      std::memcpy(bytes.data() + (i * from.size() + c) * size,
                  image->bytes.data() + (i * image->channels.size() + from[c]) * size, size);
  if (bitmap.type == TexelType::kHalf)
    check_values<std::uint16_t>(bytes, bitmap.width, bitmap.channels, half_range, findings);
  if (bitmap.type == TexelType::kFloat)
    check_values<float>(
        bytes, bitmap.width, bitmap.channels, [](float x) { return x; }, findings);
  bitmap.words.resize((bytes.size() + 3) / 4);
  std::memcpy(bitmap.words.data(), bytes.data(), bytes.size());
  return bitmap;
}

}  // namespace penumbra
