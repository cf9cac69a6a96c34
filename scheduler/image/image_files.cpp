#include "scheduler/image/image_files.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <thread>

#include "scheduler/image/tone_map.h"

// OpenEXR and libpng themselves, and not OpenImageIO, which reads images: see image_reader.h for what that
// costs.

namespace penumbra {
namespace {

/// OpenEXR goes back to write its table of lines.
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

Imf::Header header_of(const Image& image) {
  Imf::Header header(box_of(image.display), box_of(image.data));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& channel : image.channels)
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  for (const auto& [name, value] : image.metadata) {
    if (const int* number = std::get_if<int>(&value)) header.insert(name, Imf::IntAttribute(*number));
    if (const float* number = std::get_if<float>(&value)) header.insert(name, Imf::FloatAttribute(*number));
    if (const auto* text = std::get_if<std::string>(&value)) header.insert(name, Imf::StringAttribute(*text));
  }
  return header;
}

/// Where OpenEXR finds the pixels; it only reads them.
Imf::FrameBuffer frame_buffer_of(const Image& image) {
  Imf::FrameBuffer buffer;
  const std::size_t pixel_stride = image.channels.size() * sizeof(float);
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    buffer.insert(image.channels[c],
                  Imf::Slice::Make(Imf::FLOAT, image.values.data() + c, box_of(image.data), pixel_stride,
                                   pixel_stride * std::size_t(image.data.width)));
  }
  return buffer;
}

}  // namespace

Expected<std::vector<std::uint8_t>> encode_exr(const Image& image) {
  std::vector<std::uint8_t> bytes;
  try {
    MemoryStream stream(bytes);
    const int threads = int(std::max(1u, std::thread::hardware_concurrency()));
    Imf::setGlobalThreadCount(threads);
    Imf::OutputFile file(stream, header_of(image), threads);
    file.setFrameBuffer(frame_buffer_of(image));
    file.writePixels(image.data.height);
  } catch (const std::exception& error) {
    return fail(fmt::format("cannot encode the image as OpenEXR: {}", error.what()));
  }
  return bytes;
}

Expected<std::vector<std::uint8_t>> encode_png(const Image& image) {
  const auto beauty = image.beauty_channels();
  if (!beauty) return fail("cannot encode the image as PNG: it has no channels R, G, B");
  std::vector<std::uint8_t> pixels;
  pixels.reserve(image.pixels() * 3);
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (const std::size_t channel : *beauty) {
      pixels.push_back(display_byte(image.values[pixel * image.channels.size() + channel]));
    }
  }
  return encode_png_bytes(image.data.width, image.data.height, pixels);
}

Expected<std::vector<std::uint8_t>> encode_png_bytes(int width, int height,
                                                     std::span<const std::uint8_t> pixels) {
  if (width < 1 || height < 1 || pixels.size() != 3 * std::size_t(width) * std::size_t(height))
    return fail(
        fmt::format("cannot encode {} bytes as a PNG of {} × {} pixels", pixels.size(), width, height));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(width);
  png.height = png_uint_32(height);
  png.format = PNG_FORMAT_RGB;  // 8 bits, sRGB
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    return fail(fmt::format("cannot encode the image as PNG: {}", png.message));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace penumbra
