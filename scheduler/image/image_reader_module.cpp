// The implementation of the module in image_reader.h.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cstring>
#include <new>

#include "scheduler/image/image_reader.h"

namespace penumbra {
namespace {

template <std::size_t n>
std::optional<std::array<float, n>> floats_of(const OIIO::ImageSpec& spec, const char* name) {
  const OIIO::ParamValue* value = spec.find_attribute(name);
  if (value == nullptr || value->type().basetype != OIIO::TypeDesc::FLOAT ||
      value->type().numelements() * value->type().aggregate != n)
    return std::nullopt;
  std::array<float, n> floats;
  std::memcpy(floats.data(), value->data(), sizeof floats);
  return floats;
}

/// Copies metadata of the types that we write, the camera and the chromaticities. Others, such as thumbnails,
/// do not describe a render.
void copy_metadata(const OIIO::ImageSpec& spec, Image& image) {
  for (const OIIO::ParamValue& parameter : spec.extra_attribs) {
    const std::string name = parameter.name().string();
    if (parameter.type() == OIIO::TypeDesc::INT) {
      image.metadata.emplace_back(name, parameter.get_int());
    } else if (parameter.type() == OIIO::TypeDesc::FLOAT) {
      image.metadata.emplace_back(name, parameter.get<float>());
    } else if (parameter.type() == OIIO::TypeDesc::DOUBLE) {
      image.metadata.emplace_back(name, *static_cast<const double*>(parameter.data()));
    } else if (parameter.type() == OIIO::TypeDesc::STRING) {
      image.metadata.emplace_back(name, parameter.get_string());
    }
  }
  image.chromaticities = floats_of<8>(spec, "chromaticities");
  const auto to_camera = floats_of<16>(spec, "worldtocamera"), to_ndc = floats_of<16>(spec, "worldToNDC");
  if (to_camera) image.camera = {*to_camera, to_ndc};
}

Expected<Image> read(const std::filesystem::path& path, bool with_values) {
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
  if (bytes > kMostImageBytes) {
    return unreadable(fmt::format("{} x {} pixels of {} channels are more than 16 GiB", spec.width,
                                  spec.height, spec.nchannels));
  }

  Image image;
  image.data = {spec.x, spec.y, spec.width, spec.height};
  image.display = {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
  image.channels = spec.channelnames;
  copy_metadata(spec, image);
  if (!with_values) return image;
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

Expected<Image> read_file(const std::filesystem::path& path) { return read(path, true); }
Expected<Image> read_header(const std::filesystem::path& path) { return read(path, false); }

}  // namespace
}  // namespace penumbra

/// Looked up by name, see image_reader.cpp.
extern "C" const penumbra::ImageReader penumbra_image_reader{penumbra::read_file, penumbra::read_header};
