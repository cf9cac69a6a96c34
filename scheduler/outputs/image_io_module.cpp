// The module behind image_io.h: the only source that includes OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <new>

#include "scheduler/outputs/image_io.h"
#include "scheduler/outputs/tone_map.h"

namespace penumbra {
namespace {

constexpr double kMaxImageBytes = 16.0 * 1024 * 1024 * 1024;

/// Scalars of the kinds that we write; others (chromaticities, thumbnails…) say nothing about a render.
void copy_metadata(const OIIO::ImageSpec& spec, Image& image) {
  for (const OIIO::ParamValue& parameter : spec.extra_attribs) {
    const std::string name = parameter.name().string();
    if (parameter.type() == OIIO::TypeDesc::INT) {
      image.metadata.emplace_back(name, parameter.get_int());
    } else if (parameter.type() == OIIO::TypeDesc::FLOAT) {
      image.metadata.emplace_back(name, parameter.get<float>());
    } else if (parameter.type() == OIIO::TypeDesc::STRING) {
      image.metadata.emplace_back(name, parameter.get_string());
    }
  }
}

Expected<Image> read_file(const std::filesystem::path& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) return fail(fmt::format("{}: no such file", path.string()));
  if (!std::filesystem::is_regular_file(path, status)) {
    return fail(fmt::format("{}: is not a plain file", path.string()));
  }

  const auto unreadable = [&](std::string why) {
    while (!why.empty() && (why.back() == '\n' || why.back() == ' ')) why.pop_back();
    return fail(fmt::format("{}: cannot be read as an image: {}", path.string(),
                            why.empty() ? "unknown error" : why));
  };
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return unreadable(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.deep) return unreadable("deep images are not supported");
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels <= 0) {
    return unreadable("it has no pixels, or is a volume");
  }
  const double bytes = double(spec.width) * spec.height * spec.nchannels * sizeof(float);
  if (bytes > kMaxImageBytes) {
    return unreadable(fmt::format("{} x {} pixels of {} channels are more than 16 GiB", spec.width,
                                  spec.height, spec.nchannels));
  }

  Image image;
  image.data = {spec.x, spec.y, spec.width, spec.height};
  image.display = {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
  image.channels = spec.channelnames;
  copy_metadata(spec, image);
  try {
    image.values.resize(image.pixels() * image.channels.size());
  } catch (const std::bad_alloc&) {
    return unreadable(fmt::format("not enough memory for {} x {} pixels", spec.width, spec.height));
  }
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data())) {
    return unreadable(input->geterror());
  }
  return image;
}

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

Expected<std::vector<std::uint8_t>> encode_as_exr(const Image& image) {
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

Expected<std::vector<std::uint8_t>> encode_as_png(const Image& image) {
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

}  // namespace
}  // namespace penumbra

/// Looked up by name, see image_io.cpp.
extern "C" const penumbra::ImageIo penumbra_image_io{penumbra::read_file, penumbra::encode_as_exr,
                                                     penumbra::encode_as_png};
