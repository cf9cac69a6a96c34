#include "scheduler/outputs/image_files.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "scheduler/outputs/tone_map.h"

namespace penumbra {
namespace {

/// `format` is OpenImageIO's name of it; `data` holds all pixels in `type`, channels interleaved.
Expected<std::vector<std::uint8_t>> encode(const char* format, OIIO::ImageSpec spec, OIIO::TypeDesc type,
                                           const void* data) {
  const auto cannot = [&](const std::string& why) {
    return fail(fmt::format("cannot encode {}: {}", format, why));
  };
  const auto output = OIIO::ImageOutput::create(format);
  if (!output) return cannot(OIIO::geterror());
  std::vector<std::uint8_t> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<const void*>(&proxy));
  // OpenImageIO stamps the time of writing into files that say nothing of it.
  spec.attribute("DateTime", "");
  const std::string name = fmt::format("memory.{}", format == std::string_view("openexr") ? "exr" : format);
  if (!output->open(name, spec)) return cannot(output->geterror());
  if (!output->write_image(type, data)) return cannot(output->geterror());
  if (!output->close()) return cannot(output->geterror());
  return bytes;
}

}  // namespace

Expected<std::vector<std::uint8_t>> encode_exr(const Image& image) {
  OIIO::ImageSpec spec(image.data.width, image.data.height, int(image.channels.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.x = image.data.x;
  spec.y = image.data.y;
  spec.full_x = image.display.x;
  spec.full_y = image.display.y;
  spec.full_width = image.display.width;
  spec.full_height = image.display.height;
  spec.channelnames = image.channels;
  spec.attribute("compression", "zip");
  for (const auto& [name, value] : image.metadata) {
    std::visit([&](const auto& v) { spec.attribute(name, v); }, value);
  }
  return encode("openexr", spec, OIIO::TypeDesc::FLOAT, image.values.data());
}

Expected<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const auto beauty = image.beauty_channels();
  if (!beauty) return fail("cannot encode png: the image has no channels R, G, B");
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixels() * 3);
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (const std::size_t channel : *beauty) {
      bytes.push_back(display_byte(image.values[pixel * image.channels.size() + channel]));
    }
  }
  OIIO::ImageSpec spec(image.data.width, image.data.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  return encode("png", spec, OIIO::TypeDesc::UINT8, bytes.data());
}

}  // namespace penumbra
