#include "scenes/image/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/image/colour_channels.h"
#include "scenes/image/image_room.h"

namespace penumbra {
namespace {

/// A file in memory.
class MemoryInput final : public Imf::IStream {
 public:
  explicit MemoryInput(std::string_view contents) : Imf::IStream("memory"), contents_(contents) {}
  bool read(char to[], int count) override {
    if (count < 0 || at_ > contents_.size() || std::size_t(count) > contents_.size() - at_)
      throw std::runtime_error("the file ends early");
    std::memcpy(to, contents_.data() + at_, std::size_t(count));
    at_ += std::size_t(count);
    return at_ < contents_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  std::string_view contents_;
  std::size_t at_ = 0;
};

std::vector<std::string> channel_names(const Imf::Header& header) {
  std::vector<std::string> names;
  for (auto each = header.channels().begin(); each != header.channels().end(); ++each)
    names.emplace_back(each.name());
  return names;
}

bool is_deep(const Imf::Header& header) { return header.hasType() && Imf::isDeepData(header.type()); }

/// The part to be read.
Expected<int> chosen_part(const Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    const std::vector<std::string> names = channel_names(file.header(part));
    // A part of one channel may be a depth.
    const bool is_one = names.size() == 1 && file.parts() > 1 && colour_of(names.front()) != 'Y';
    if (!is_deep(file.header(part)) && !is_one && has_colours(names)) return part;
  }
  for (int part = 0; part < file.parts(); ++part)
    if (is_deep(file.header(part))) return fail("is a deep image; flatten it");
  if (file.parts() == 1) return fail(no_colours_text(channel_names(file.header(0))));
  return fail(fmt::format("has {} parts, none of which has colours; the first {}", file.parts(),
                          no_colours_text(channel_names(file.header(0)))));
}

/// The channels that are read, in the order that they have in a texel.
std::vector<std::string> chosen_channels(const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const char colour : {'R', 'G', 'B', 'Y', 'A'})
    if (const auto at = index_of_colour(names, colour)) chosen.push_back(names[*at]);
  return chosen.empty() ? names : chosen;
}

/// The chromaticities, if they are others than Rec. 709's.
std::optional<Chromaticities> other_primaries(const Imf::Header& header) {
  if (!Imf::hasChromaticities(header)) return std::nullopt;
  const Imf::Chromaticities& said = Imf::chromaticities(header);
  const Chromaticities all = {said.red.x,  said.red.y,  said.green.x, said.green.y,
                              said.blue.x, said.blue.y, said.white.x, said.white.y};
  return are_rec709(all) ? std::nullopt : std::optional(all);
}

/// Luminance with chroma at every second texel, as OpenEXR itself reconstructs colours from it: as halfs.
void read_luminance_chroma(std::string_view contents, const Imath::Box2i& window, ImageContents& image) {
  MemoryInput stream(contents);
  Imf::RgbaInputFile file(stream, 0);
  auto* texels = reinterpret_cast<Imf::Rgba*>(image.bytes.data());
  file.setFrameBuffer(Imf::ComputeBasePointer(texels, window), 1, std::size_t(image.width));
  file.readPixels(window.min.y, window.max.y);
}

/// Floats of halfs.
void widen(ImageContents& image) {
  std::vector<std::byte> wide(image.bytes.size() * 2);
  for (std::size_t i = 0; i < image.bytes.size() / sizeof(half); ++i) {
    half value;
    std::memcpy(&value, image.bytes.data() + i * sizeof(half), sizeof(half));
    const float number = value;
    std::memcpy(wide.data() + i * sizeof(float), &number, sizeof(float));
  }
  image.bytes = std::move(wide);
  image.type = TexelType::kFloat;
}

Expected<ImageContents> read_parts(std::string_view contents, std::size_t most_bytes) {
  MemoryInput stream(contents);
  Imf::MultiPartInputFile parts(stream, 0);
  const auto chosen = chosen_part(parts);
  if (!chosen) return std::unexpected(chosen.error());
  const Imf::Header& header = parts.header(*chosen);
  const std::vector<std::string> names = channel_names(header);
  const auto has = [&](const char* name) { return header.channels().findChannel(name) != nullptr; };
  const bool has_rgb = index_of_colour(names, 'R').has_value();
  if (!has_rgb && has("X") && has("Y") && has("Z"))
    return fail(
        "has the channels X, Y and Z, which may be colours of CIE XYZ or positions; name them R, G, B");
  const bool is_chroma = !has_rgb && has("RY") && has("BY") && has("Y");
  if (is_chroma && parts.parts() > 1)
    return fail("has luminance and chroma (Y, RY, BY) in one of several parts; write R, G and B");

  const Imath::Box2i window = header.dataWindow();
  ImageContents image;
  image.width = window.max.x - window.min.x + 1;  // OpenEXR has checked that windows are far below 2^31
  image.height = window.max.y - window.min.y + 1;
  image.chromaticities = other_primaries(header);
  image.channels = is_chroma ? std::vector<std::string>{"R", "G", "B", "A"} : chosen_channels(names);
  std::optional<Imf::PixelType> type;
  for (const std::string& name : image.channels) {
    const Imf::PixelType own = is_chroma ? Imf::HALF : header.channels().findChannel(name)->type;
    type = own == Imf::UINT || (type && own != *type) ? Imf::FLOAT : own;
    if (*type != own) break;
  }
  if (image.chromaticities && !is_chroma) type = Imf::FLOAT;
  image.type = *type == Imf::HALF ? TexelType::kHalf : TexelType::kFloat;
  if (auto room = make_room(image, most_bytes); !room) return std::unexpected(room.error());
  if (is_chroma) {
    read_luminance_chroma(contents, window, image);
    if (image.chromaticities) widen(image);
    return image;
  }
  const std::size_t size = size_of(image.type), texel = size * image.channels.size();
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    buffer.insert(image.channels[c], Imf::Slice::Make(*type, image.bytes.data() + c * size, window, texel,
                                                      texel * std::size_t(image.width)));
  Imf::InputPart part(parts, *chosen);
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  return image;
}

}  // namespace

bool is_exr(std::string_view contents) { return contents.starts_with("\x76\x2f\x31\x01"); }

Expected<ImageContents> read_exr(std::string_view contents, std::size_t most_bytes) {
  try {
    return read_parts(contents, most_bytes);
  } catch (const std::bad_alloc&) {
    return fail("has more pixels than there is memory for");
  } catch (const std::exception& problem) {
    return fail(fmt::format("cannot be read as an image: {}", one_line(problem.what())));
  }
}

}  // namespace penumbra
