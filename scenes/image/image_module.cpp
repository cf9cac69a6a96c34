// The implementation of the module in image_module.h.
#include "scenes/image/image_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cstdint>
#include <new>

#include "scenes/image/image_room.h"

namespace penumbra {
namespace {

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
  const TexelType type = type_of(spec);
  Chromaticities said{};
  if ((type != TexelType::kHalf && type != TexelType::kFloat) ||
      !spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, int(said.size())),
                         said.data()))
    return std::nullopt;
  return are_rec709(said) ? std::nullopt : std::optional(said);
}

/// Whether the first directory of a TIFF file has no BitsPerSample. That means 1 (TIFF 6.0, p. 29), but
/// OpenImageIO 2.4 takes it for 8 and the packed bits for values.
bool is_tiff_without_bits(std::string_view file) {
  const bool is_big_endian = file.starts_with(std::string_view("MM\0*", 4));
  if (!is_big_endian && !file.starts_with(std::string_view("II*\0", 4))) return false;
  constexpr std::size_t kEntry = 12, kBitsPerSample = 258;
  const auto number = [&](std::size_t at, std::size_t size) {
    std::size_t value = 0;
    for (std::size_t i = 0; i < size && at + i < file.size(); ++i)
      value |= std::size_t(std::uint8_t(file[at + i])) << 8 * (is_big_endian ? size - 1 - i : i);
    return value;
  };
  const std::size_t directory = number(4, 4), entries = number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i)
    if (number(directory + 2 + kEntry * i, 2) == kBitsPerSample) return false;
  return entries > 0;
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
  if (auto room = make_room(image, most_bytes); !room) return std::unexpected(room.error());
  const bool done = input.read_image(0, 0, 0, spec.nchannels, format_of(image.type), image.bytes.data());
  // For truncated files the readers of JPEG and TIFF fill in the rest and report an error.
  const std::string problem = input.geterror();
  if (!done || !problem.empty())
    return fail(fmt::format("cannot be read as an image: {}", one_line(problem)));
  return image;
}

Expected<ImageContents> read_file(const std::string& name, std::string_view contents,
                                  std::size_t most_bytes) {
  if (is_tiff_without_bits(contents))
    return fail("states no bits per sample, and black and white by one bit are not read; write 8 bits");
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
