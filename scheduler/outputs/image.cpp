#include "scheduler/outputs/image.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <new>

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

}  // namespace

std::optional<std::size_t> Image::channel(std::string_view name) const {
  const auto found = std::ranges::find(channels, name);
  if (found == channels.end()) return std::nullopt;
  return std::size_t(found - channels.begin());
}

std::optional<std::array<std::size_t, 3>> Image::beauty_channels() const {
  const auto r = channel("R"), g = channel("G"), b = channel("B");
  if (r && g && b) return std::array{*r, *g, *b};
  const auto grey = channels.size() == 1 ? std::optional<std::size_t>(0) : channel("Y");
  if (grey) return std::array{*grey, *grey, *grey};
  return std::nullopt;
}

std::optional<MetadataValue> Image::attribute(std::string_view name) const {
  const auto found = std::ranges::find(metadata, name, [](const auto& entry) { return entry.first; });
  if (found == metadata.end()) return std::nullopt;
  return found->second;
}

Expected<Image> read_image(const std::filesystem::path& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) return fail(fmt::format("{}: no such file", path.string()));
  if (std::filesystem::is_directory(path, status)) return fail(fmt::format("{}: is a folder", path.string()));

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

}  // namespace penumbra
