#include "scheduler/image/image.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {

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

std::string metadata_text(const Image& image, std::string_view name) {
  const auto value = image.attribute(name);
  return value ? std::visit([](const auto& v) { return fmt::format("{}", v); }, *value) : std::string();
}

ChannelName split_channel(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  if (dot == std::string_view::npos) return {"", channel};
  return {channel.substr(0, dot), channel.substr(dot + 1)};
}

bool is_display_image(const Image& image) { return metadata_text(image, "oiio:ColorSpace") == "sRGB"; }

bool describes_file(std::string_view name) {
  // OpenEXR's own attributes, which its writer sets, and OpenImageIO's names for some of them.
  static constexpr std::string_view kOfFiles[] = {
      "compression",   "lineOrder",          "name",        "type",
      "version",       "chunkCount",         "view",        "PixelAspectRatio",
      "channels",      "dataWindow",         "preview",     "pixelAspectRatio",
      "tiles",         "screenWindowCenter", "multiView",   "Orientation",
      "planarconfig",  "ResolutionUnit",     "XResolution", "YResolution",
      "displayWindow", "screenWindowWidth"};
  const auto begins = [&](std::string_view prefix) { return name.starts_with(prefix); };
  return begins("oiio:") || begins("openexr:") || begins("png:") || begins("jpeg:") || begins("tiff:") ||
         std::ranges::find(kOfFiles, name) != std::end(kOfFiles);
}

}  // namespace penumbra
