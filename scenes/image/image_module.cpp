// The implementation of the module in image_module.h.
#include "scenes/image/image_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace penumbra {
namespace {

/// OpenImageIO's message in one line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text.empty() ? "unknown error" : text;
}

/// Texels keep their type; types without a counterpart become float.
TexelType type_of(const OIIO::ImageSpec& spec) {
  if (!spec.channelformats.empty()) return TexelType::kFloat;
  switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
      return TexelType::kByte;
    case OIIO::TypeDesc::UINT16:
      return TexelType::kShort;
    case OIIO::TypeDesc::HALF:
      return TexelType::kHalf;
    default:
      return TexelType::kFloat;
  }
}

OIIO::TypeDesc format_of(TexelType type) {
  switch (type) {
    case TexelType::kByte:
      return OIIO::TypeDesc::UINT8;
    case TexelType::kShort:
      return OIIO::TypeDesc::UINT16;
    case TexelType::kHalf:
      return OIIO::TypeDesc::HALF;
    default:
      return OIIO::TypeDesc::FLOAT;
  }
}

/// The chromaticities of an image of linear light, if they are others than Rec. 709's.
std::optional<Chromaticities> other_primaries(const OIIO::ImageSpec& spec) {
  constexpr float kSame = 1e-4f;  // files have four decimals
  const TexelType type = type_of(spec);
  Chromaticities said{};
  if ((type != TexelType::kHalf && type != TexelType::kFloat) ||
      !spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, int(said.size())),
                         said.data()))
    return std::nullopt;
  const bool same =
      std::ranges::equal(said, kRec709, [](float a, float b) { return std::abs(a - b) <= kSame; });
  return same ? std::nullopt : std::optional(said);
}

Expected<ImageContents> read_pixels(OIIO::ImageInput& input, std::size_t most_bytes) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.deep) return fail("is a deep image; flatten it");
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels <= 0)
    return fail(fmt::format("has no pixels: {} x {}", spec.width, spec.height));
  ImageContents image;
  image.width = spec.width;
  image.height = spec.height;
  image.channels = spec.channelnames;
  image.type = type_of(spec);
  image.chromaticities = other_primaries(spec);
  if (image.chromaticities) image.type = TexelType::kFloat;
  const double bytes = double(spec.width) * spec.height * spec.nchannels * double(size_of(image.type));
  if (bytes > double(most_bytes)) {
    return fail(
        fmt::format("has {} x {} texels of {} channels, {:.1f} GiB; {:.0f} GiB are the most that a "
                    "texture may take: scale it down",
                    spec.width, spec.height, spec.nchannels, bytes / double(1 << 30),
                    double(most_bytes) / double(1 << 30)));
  }
  image.bytes.resize(std::size_t(bytes));
  const bool done = input.read_image(0, 0, 0, spec.nchannels, format_of(image.type), image.bytes.data());
  // For truncated files the readers of JPEG and TIFF fill in the rest and report an error.
  const std::string problem = input.geterror();
  if (!done || !problem.empty())
    return fail(fmt::format("cannot be read as an image: {}", one_line(problem)));
  return image;
}

Expected<ImageContents> read_file(const std::string& name, std::string_view contents,
                                  std::size_t most_bytes) {
  OIIO::Filesystem::IOMemReader memory(contents.data(), contents.size());
  OIIO::ImageSpec wishes;
  wishes["oiio:UnassociatedAlpha"] = 1;  // colours as stored in the file
  try {
    // Formats that cannot be read from memory are read from their file instead.
    OIIO::ImageSpec from_memory = wishes;
    void* proxy = &memory;
    // As an attribute, because passing it to open() does not work for names that are not files (OpenImageIO
    // 2.4).
    from_memory.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    auto input = OIIO::ImageInput::open(name, &from_memory);
    if (!input) {
      static_cast<void>(OIIO::geterror());
      input = OIIO::ImageInput::open(name, &wishes);
    }
    if (!input) return fail(fmt::format("cannot be read as an image: {}", one_line(OIIO::geterror())));
    return read_pixels(*input, most_bytes);
  } catch (const std::bad_alloc&) {
    return fail("has more pixels than there is memory for");
  } catch (const std::exception& problem) {
    return fail(fmt::format("cannot be read as an image: {}", one_line(problem.what())));
  }
}

}  // namespace
}  // namespace penumbra

/// Looked up by name, see bitmap_reader.cpp.
extern "C" const penumbra::TexelReader penumbra_texel_reader{penumbra::read_file};
