#include "scheduler/image/exr_reader.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <ImfVersion.h>
#include <strings.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <tuple>

namespace penumbra {
namespace {

/// OpenImageIO's order: by layer, in it first those of its list, then by name.
std::vector<std::string> in_order(std::vector<std::string> names) {
  static constexpr std::string_view kFirst[] = {"R",    "Red",  "G",  "Green", "B",     "Blue", "Y",
                                                "real", "imag", "A",  "Alpha", "AR",    "RA",   "AG",
                                                "GA",   "AB",   "BA", "Z",     "Depth", "Zback"};
  const auto key = [](const std::string& name) {
    const ChannelName parts = split_channel(name);
    const auto* const first = std::ranges::find_if(kFirst, [&](std::string_view each) {
      return each.size() == parts.component.size() &&
             strncasecmp(each.data(), parts.component.data(), each.size()) == 0;
    });
    return std::tuple(parts.layer, first - std::begin(kFirst), parts.component);
  };
  std::ranges::sort(names, [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return names;
}

PixelWindow window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

RowMatrix rows_of(const Imath::M44f& matrix) {
  RowMatrix rows;
  std::copy_n(&matrix.x[0][0], rows.size(), rows.begin());
  return rows;
}

/// Whether the attribute is one that OpenImageIO takes under another name, unless it describes the file.
bool is_renamed(std::string_view name) { return name.find_first_of(":/") == name.npos; }

/// The attributes; false: there is one that OpenImageIO reads differently.
bool read_attributes(const Imf::Header& header, Image& image) {
  for (auto each = header.begin(); each != header.end(); ++each) {
    const std::string name = each.name();
    if (describes_file(name) || name == "chromaticities" || name == "worldToCamera" || name == "worldToNDC")
      continue;
    if (is_renamed(name)) return false;
    const Imf::Attribute* value = &each.attribute();
    if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(value))
      image.metadata.emplace_back(name, number->value());
    else if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(value))
      image.metadata.emplace_back(name, real->value());
    else if (const auto* precise = dynamic_cast<const Imf::DoubleAttribute*>(value))
      image.metadata.emplace_back(name, precise->value());
    else if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(value))
      image.metadata.emplace_back(name, text->value());
  }
  static constexpr const char* kCompressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                                  "pxr24", "b44", "b44a", "dwaa", "dwab"};
  const auto compression = std::size_t(header.compression());
  if (compression >= std::size(kCompressions)) return false;
  image.metadata.emplace_back("compression", kCompressions[compression]);
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    image.chromaticities = {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
  }
  if (Imf::hasWorldToCamera(header)) {
    image.camera = {rows_of(Imf::worldToCamera(header)), {}};
    if (Imf::hasWorldToNDC(header)) image.camera->world_to_ndc = rows_of(Imf::worldToNDC(header));
  }
  return true;
}

bool is_plain(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  bool is_tiled = false, is_deep = false, has_parts = false;
  return Imf::isOpenExrFile(path.c_str(), is_tiled, is_deep, has_parts) && !is_tiled && !is_deep &&
         !has_parts;
}

std::optional<Image> read(const std::filesystem::path& path, bool with_values) {
  if (!is_plain(path)) return std::nullopt;
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  Image image;
  image.data = window_of(header.dataWindow());
  image.display = window_of(header.displayWindow());
  std::vector<std::string> names;
  for (auto each = header.channels().begin(); each != header.channels().end(); ++each) {
    const Imf::Channel& channel = each.channel();
    if (channel.type == Imf::UINT || channel.xSampling != 1 || channel.ySampling != 1) return std::nullopt;
    names.emplace_back(each.name());
  }
  if (names.empty() || !read_attributes(header, image)) return std::nullopt;
  image.channels = in_order(std::move(names));
  const double bytes =
      double(image.data.width) * image.data.height * double(image.channels.size()) * sizeof(float);
  if (bytes > kMostImageBytes) return std::nullopt;
  if (!with_values) return image;
  image.values.resize(image.pixels() * image.channels.size());
  const std::size_t pixel = image.channels.size() * sizeof(float);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    buffer.insert(image.channels[c],
                  Imf::Slice::Make(Imf::FLOAT, image.values.data() + c, header.dataWindow(), pixel,
                                   pixel * std::size_t(image.data.width)));
  file.setFrameBuffer(buffer);
  file.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
  return image;
}

}  // namespace

std::optional<Image> read_plain_exr(const std::filesystem::path& path, bool with_values) {
  try {
    return read(path, with_values);
  } catch (const std::exception&) {  // damaged, or no memory: the general reader says what is wrong
    return std::nullopt;
  }
}

}  // namespace penumbra
