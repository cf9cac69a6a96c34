#include "scheduler/image/image_files.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <exception>

#include "kernels/host/parallel.h"
#include "scheduler/image/picture.h"

// Uses OpenEXR and libpng directly instead of OpenImageIO, which reads images; image_reader.h tells what that
// would cost.

namespace penumbra {
namespace {

constexpr float kMostHalf = 65504.0f;

/// A seekable stream in memory: OpenEXR goes back to write its table of lines.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(std::vector<std::uint8_t>& bytes) : Imf::OStream("memory"), bytes_(bytes) {}
  void write(const char data[], int size) override {
    bytes_.resize(std::max(bytes_.size(), position_ + std::size_t(size)));
    std::memcpy(bytes_.data() + position_, data, std::size_t(size));
    position_ += std::size_t(size);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

 private:
  std::vector<std::uint8_t>& bytes_;
  std::size_t position_ = 0;
};

Imath::Box2i box_of(const PixelWindow& window) {
  return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

Imf::Compression compression_of(ExrCompression compression) {
  constexpr Imf::Compression kOf[] = {Imf::NO_COMPRESSION,  Imf::RLE_COMPRESSION,  Imf::ZIPS_COMPRESSION,
                                      Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION,  Imf::PXR24_COMPRESSION,
                                      Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION,
                                      Imf::DWAB_COMPRESSION};
  return kOf[int(compression)];
}

Imath::M44f matrix_of(const RowMatrix& m) {
  return {m[0], m[1], m[2],  m[3],  m[4],  m[5],  m[6],  m[7],
          m[8], m[9], m[10], m[11], m[12], m[13], m[14], m[15]};
}

void add_standard_attributes(const Image& image, Imf::Header& header) {
  if (image.chromaticities) {
    const Chromaticities& c = *image.chromaticities;
    Imf::addChromaticities(header, {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}});
  }
  if (image.camera) {
    Imf::addWorldToCamera(header, matrix_of(image.camera->world_to_camera));
    if (image.camera->world_to_ndc) Imf::addWorldToNDC(header, matrix_of(*image.camera->world_to_ndc));
  }
}

Imf::PixelType type_of(const std::string& channel, const ExrEncoding& encoding) {
  return encoding.half && is_half_channel(channel) ? Imf::HALF : Imf::FLOAT;
}

/// The channels of an image that belong to one part of the file.
struct Part {
  const char* name;
  std::size_t first_channel, end_channel;
  Imf::Compression compression;
};

/// Whether the metadata belong to the exact channels.
bool is_of_exact(std::string_view name) { return name.starts_with("cryptomatte/"); }

/// One part, but if the compression would change floats, exact channels get a part of their own.
std::vector<Part> parts_of(const Image& image, const ExrEncoding& encoding) {
  const std::size_t all = image.channels.size(), others = all - image.exact_channels;
  const Imf::Compression compression = compression_of(encoding.compression);
  const bool changes_floats = compression == Imf::PXR24_COMPRESSION || compression == Imf::DWAA_COMPRESSION ||
                              compression == Imf::DWAB_COMPRESSION;
  if (image.exact_channels == 0 || !changes_floats) return {{"image", 0, all, compression}};
  return {{"image", 0, others, compression}, {"cryptomatte", others, all, Imf::ZIP_COMPRESSION}};
}

Imf::Header header_of(const Image& image, const ExrEncoding& encoding, const Part& part) {
  Imf::Header header(box_of(image.display), box_of(image.data));
  header.compression() = part.compression;
  // Two thirds to four fifths of the time of OpenEXR's own level, for 1 to 2 % more bytes.
  header.zipCompressionLevel() = 3;
  for (std::size_t c = part.first_channel; c < part.end_channel; ++c)
    header.channels().insert(image.channels[c], Imf::Channel(type_of(image.channels[c], encoding)));
  add_standard_attributes(image, header);
  const bool is_all = part.end_channel - part.first_channel == image.channels.size();
  for (const auto& [name, value] : image.metadata) {
    if (!is_all && is_of_exact(name) != (part.first_channel > 0)) continue;
    if (const int* number = std::get_if<int>(&value)) header.insert(name, Imf::IntAttribute(*number));
    if (const float* number = std::get_if<float>(&value)) header.insert(name, Imf::FloatAttribute(*number));
    if (const auto* number = std::get_if<double>(&value)) header.insert(name, Imf::DoubleAttribute(*number));
    if (const auto* text = std::get_if<std::string>(&value)) header.insert(name, Imf::StringAttribute(*text));
  }
  if (is_all) return header;
  header.setName(part.name);
  header.setType(Imf::SCANLINEIMAGE);
  return header;
}

/// The channels that are stored with 16 bits, one after the other, rounded to nearest.
std::vector<half> halves_of(const Image& image, const ExrEncoding& encoding) {
  std::vector<half> halves;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    if (type_of(image.channels[c], encoding) != Imf::HALF) continue;
    for (std::size_t i = c; i < image.values.size(); i += image.channels.size()) {
      const float value = image.values[i];
      const bool finite = std::isfinite(value);
      halves.emplace_back(finite ? std::clamp(value, -kMostHalf, kMostHalf) : value);
    }
  }
  return halves;
}

/// Describes the pixels to OpenEXR, which only reads them. Halves belong to the first part.
Imf::FrameBuffer frame_buffer_of(const Image& image, const ExrEncoding& encoding, const Part& part,
                                 const std::vector<half>& halves) {
  Imf::FrameBuffer buffer;
  const half* next = halves.data();
  const std::size_t pixel_stride = image.channels.size() * sizeof(float);
  for (std::size_t c = part.first_channel; c < part.end_channel; ++c) {
    if (type_of(image.channels[c], encoding) == Imf::HALF) {
      buffer.insert(image.channels[c], Imf::Slice::Make(Imf::HALF, next, box_of(image.data), sizeof(half),
                                                        sizeof(half) * std::size_t(image.data.width)));
      next += image.pixels();
      continue;
    }
    buffer.insert(image.channels[c],
                  Imf::Slice::Make(Imf::FLOAT, image.values.data() + c, box_of(image.data), pixel_stride,
                                   pixel_stride * std::size_t(image.data.width)));
  }
  return buffer;
}

/// The number of OpenEXR's threads, which are started once per process.
int compression_threads() {
  static const int threads = [] {
    const int count = int(core_count());
    Imf::setGlobalThreadCount(count);
    return count;
  }();
  return threads;
}

/// Makes all libpng calls from the header to the end. Returns whether they succeeded. No object here has a
/// destructor, because libpng leaves by longjmp on an error.
bool write_png(png_structp png, png_infop info, int width, int height, const std::uint8_t* pixels,
               bool alpha) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), 8,
               alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  // After filtering, a render contains few repetitions except runs. Searching for others takes 2 to 7 times
  // as long and saves 0 to 1 % of the bytes.
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
  png_set_compression_strategy(png, Z_RLE);
  png_write_info(png, info);
  const std::size_t row = std::size_t(width) * (alpha ? 4 : 3);
  for (int y = 0; y < height; ++y) png_write_row(png, pixels + std::size_t(y) * row);
  png_write_end(png, info);
  return true;
}

struct PngTarget {
  std::vector<std::uint8_t> bytes;
  std::string error;
};

/// Encodes display-ready pixels with or without alpha.
Expected<std::vector<std::uint8_t>> encode_png_pixels(int width, int height,
                                                      std::span<const std::uint8_t> pixels, bool alpha) {
  PngTarget target;
  const auto on_error = [](png_structp png, png_const_charp message) {
    static_cast<PngTarget*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
  };
  const auto on_warning = [](png_structp, png_const_charp) {};
  const auto append = [](png_structp png, png_bytep bytes, png_size_t count) {
    std::vector<std::uint8_t>& all = static_cast<PngTarget*>(png_get_io_ptr(png))->bytes;
    try {
      all.insert(all.end(), bytes, bytes + count);
      return;
    } catch (const std::exception&) {
    }
    png_error(png, "no memory is left");  // an exception must not pass through libpng
  };
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &target, on_error, on_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info != nullptr) png_set_write_fn(png, &target, append, [](png_structp) {});
  const bool written = info != nullptr && write_png(png, info, width, height, pixels.data(), alpha);
  png_destroy_write_struct(&png, &info);
  if (written) return std::move(target.bytes);
  return fail(fmt::format("cannot encode the image as PNG: {}",
                          target.error.empty() ? "no memory is left" : target.error));
}

}  // namespace

bool is_half_channel(std::string_view name) {
  const std::string_view layer = name.substr(0, name.find('.'));
  return layer.size() == name.size()
             ? name != "Z"
             : layer == "albedo" || layer == "normal" || layer == "analytic" || layer == "difference" ||
                   layer == "visibility" || layer == "half_a" || layer == "half_b" ||
                   layer == "geometric_normal" || layer == "direct" || layer == "indirect";
}

std::uint64_t values_beyond_half(const Image& image) {
  std::uint64_t beyond = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (std::isfinite(image.values[i]) && std::abs(image.values[i]) > kMostHalf &&
        is_half_channel(image.channels[i % image.channels.size()]))
      ++beyond;
  return beyond;
}

Expected<std::vector<std::uint8_t>> encode_exr(const Image& image, const ExrEncoding& encoding) {
  std::vector<std::uint8_t> bytes;
  try {
    // Unused capacity takes no memory, while growing would copy the contents repeatedly.
    bytes.reserve(image.values.size() * sizeof(float));
    MemoryStream stream(bytes);
    const int threads = compression_threads();
    const std::vector<half> halves = halves_of(image, encoding);
    const std::vector<Part> parts = parts_of(image, encoding);
    std::vector<Imf::Header> headers;
    for (const Part& part : parts) headers.push_back(header_of(image, encoding, part));
    const auto write = [&](auto&& file, const Part& part) {
      file.setFrameBuffer(frame_buffer_of(image, encoding, part, halves));
      file.writePixels(image.data.height);
    };
    if (parts.size() == 1) {
      write(Imf::OutputFile(stream, headers[0], threads), parts[0]);
    } else {
      Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()), false, threads);
      for (std::size_t k = 0; k < parts.size(); ++k) write(Imf::OutputPart(file, int(k)), parts[k]);
    }
  } catch (const std::exception& error) {
    return fail(fmt::format("cannot encode the image as OpenEXR: {}", error.what()));
  }
  return bytes;
}

Expected<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const auto picture = picture_of(image);
  if (!picture) return fail("cannot encode the image as PNG: it " + picture.error().message);
  return encode_png_pixels(image.data.width, image.data.height, picture->pixels, picture->has_alpha);
}

Expected<std::vector<std::uint8_t>> encode_png_bytes(int width, int height,
                                                     std::span<const std::uint8_t> pixels, bool has_alpha) {
  const std::size_t channels = has_alpha ? 4 : 3;
  if (width < 1 || height < 1 || pixels.size() != channels * std::size_t(width) * std::size_t(height))
    return fail(
        fmt::format("cannot encode {} bytes as a PNG of {} × {} pixels", pixels.size(), width, height));
  return encode_png_pixels(width, height, pixels, has_alpha);
}

}  // namespace penumbra
