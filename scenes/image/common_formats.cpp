#include "scenes/image/common_formats.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

// After stdio.h, which it needs.
#include <jpeglib.h>

// Only Radiance's format is compiled of it.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace penumbra {
namespace {

// JPEG and PNG: no object of the functions that call setjmp has a destructor, because the libraries leave
// them by longjmp.

std::vector<std::string> channel_names(int channels) {
  if (channels <= 2)
    return channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"Y", "A"};
  return channels == 3 ? std::vector<std::string>{"R", "G", "B"}
                       : std::vector<std::string>{"R", "G", "B", "A"};
}

/// Makes room for the texels. Returns whether that many are allowed and there is memory for them.
bool make_room(ImageContents& image, std::size_t most_bytes) {
  const double bytes = double(image.width) * double(image.height) * double(image.channels.size()) *
                       double(size_of(image.type));
  if (bytes > double(most_bytes)) return false;
  try {
    image.bytes.resize(std::size_t(bytes));
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

bool start_image(int channels, TexelType type, std::size_t most_bytes, ImageContents& image) {
  image.channels = channel_names(channels);
  image.type = type;
  return make_room(image, most_bytes);
}

struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf leave;
};

[[noreturn]] void leave_jpeg(j_common_ptr file) {
  std::longjmp(reinterpret_cast<JpegErrors*>(file->err)->leave, 1);
}

bool decode_jpeg(jpeg_decompress_struct& file, JpegErrors& errors, std::string_view contents,
                 std::size_t most_bytes, ImageContents& image) {
  if (setjmp(errors.leave) != 0) return false;
  jpeg_create_decompress(&file);
  jpeg_mem_src(&file, reinterpret_cast<const unsigned char*>(contents.data()), contents.size());
  if (jpeg_read_header(&file, TRUE) != JPEG_HEADER_OK) return false;
  const bool grey = file.jpeg_color_space == JCS_GRAYSCALE && file.num_components == 1;
  const bool coloured =
      (file.jpeg_color_space == JCS_YCbCr || file.jpeg_color_space == JCS_RGB) && file.num_components == 3;
  if ((!grey && !coloured) || file.data_precision != 8) return false;
  jpeg_start_decompress(&file);
  image.width = int(file.output_width);
  image.height = int(file.output_height);
  if (!start_image(file.output_components, TexelType::kByte, most_bytes, image)) return false;
  const std::size_t row = std::size_t(file.output_width) * std::size_t(file.output_components);
  while (file.output_scanline < file.output_height) {
    auto* to = reinterpret_cast<unsigned char*>(image.bytes.data()) + file.output_scanline * row;
    jpeg_read_scanlines(&file, &to, 1);
  }
  jpeg_finish_decompress(&file);
  return errors.manager.num_warnings == 0;
}

bool read_jpeg(std::string_view contents, std::size_t most_bytes, ImageContents& image) {
  jpeg_decompress_struct file{};
  JpegErrors errors{};
  file.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leave_jpeg;
  // It counts warnings itself; what it would print is left out.
  errors.manager.output_message = [](j_common_ptr) {};
  const bool done = decode_jpeg(file, errors, contents, most_bytes, image);
  jpeg_destroy_decompress(&file);
  return done;
}

[[noreturn]] void leave_png(png_structp png, png_const_charp) { png_longjmp(png, 1); }

void read_png_bytes(png_structp png, png_bytep to, png_size_t count) {
  auto& left = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > left.size()) png_error(png, "the file ends early");
  std::memcpy(to, left.data(), count);
  left.remove_prefix(count);
}

/// PNG files without palettes, of 8 or 16 bits, that need no conversion.
bool decode_png(png_structp png, png_infop info, std::size_t most_bytes, ImageContents& image) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  const int colours = png_get_color_type(png, info), bits = png_get_bit_depth(png, info);
  if (colours == PNG_COLOR_TYPE_PALETTE || bits < 8 || png_get_valid(png, info, PNG_INFO_tRNS) != 0 ||
      png_get_interlace_type(png, info) != PNG_INTERLACE_NONE)
    return false;
  if (bits == 16) png_set_swap(png);  // to the order of this machine
  image.width = int(png_get_image_width(png, info));
  image.height = int(png_get_image_height(png, info));
  const TexelType type = bits == 16 ? TexelType::kShort : TexelType::kByte;
  if (!start_image(png_get_channels(png, info), type, most_bytes, image)) return false;
  const std::size_t row = image.bytes.size() / std::size_t(image.height);
  for (int y = 0; y < image.height; ++y)
    png_read_row(png, reinterpret_cast<png_bytep>(image.bytes.data()) + std::size_t(y) * row, nullptr);
  png_read_end(png, nullptr);
  return true;
}

bool read_png(std::string_view contents, std::size_t most_bytes, ImageContents& image) {
  // Warnings are for odd files, too.
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_png, leave_png);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info != nullptr) png_set_read_fn(png, &contents, read_png_bytes);
  const bool done = info != nullptr && decode_png(png, info, most_bytes, image);
  png_destroy_read_struct(&png, &info, nullptr);
  return done;
}

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

/// OpenEXR files of one part whose channels are colours of one type.
bool read_exr(std::string_view contents, std::size_t most_bytes, ImageContents& image) {
  MemoryInput stream(contents);
  Imf::MultiPartInputFile parts(stream, 0);
  const Imf::Header& header = parts.header(0);
  const bool is_flat =
      !header.hasType() || header.type() == Imf::SCANLINEIMAGE || header.type() == Imf::TILEDIMAGE;
  if (parts.parts() != 1 || !is_flat || Imf::hasChromaticities(header)) return false;
  const Imath::Box2i window = header.dataWindow();
  image.width = window.max.x - window.min.x + 1;
  image.height = window.max.y - window.min.y + 1;
  std::optional<Imf::PixelType> type;
  // In the order that the channels have in a texel.
  for (const char* name : {"R", "G", "B", "Y", "A"}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (channel == nullptr) continue;
    if (channel->type == Imf::UINT || (type && channel->type != *type) || channel->xSampling != 1 ||
        channel->ySampling != 1)
      return false;
    type = channel->type;
    image.channels.emplace_back(name);
  }
  std::size_t count = 0;
  for (auto each = header.channels().begin(); each != header.channels().end(); ++each) ++count;
  if (!type || count != image.channels.size()) return false;
  image.type = *type == Imf::HALF ? TexelType::kHalf : TexelType::kFloat;
  if (!make_room(image, most_bytes)) return false;
  const std::size_t size = size_of(image.type), texel = size * count;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < count; ++c)
    buffer.insert(image.channels[c], Imf::Slice::Make(*type, image.bytes.data() + c * size, window, texel,
                                                      texel * std::size_t(image.width)));
  Imf::InputPart part(parts, 0);
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  return true;
}

/// What is left of a Radiance picture.
struct Stream {
  std::string_view left;
  bool ended_early = false;  ///< more was asked for than there is
};

// stb asks for more only if it needs more. After the end of a file it would wait for its data for ever, or
// take zeros for them. Line ends instead end its header and let every run of texels get on.
int read_bytes(void* user, char* to, int count) {
  auto& stream = *static_cast<Stream*>(user);
  const std::size_t given = std::min(std::size_t(count), stream.left.size());
  std::memcpy(to, stream.left.data(), given);
  stream.left.remove_prefix(given);
  if (given > 0) return int(given);
  stream.ended_early = true;
  std::memset(to, '\n', std::size_t(count));
  return count;
}
void skip_bytes(void* user, int count) {
  auto& stream = *static_cast<Stream*>(user);
  stream.left.remove_prefix(std::min(std::size_t(std::max(count, 0)), stream.left.size()));
}
int is_at_end(void* user) { return static_cast<Stream*>(user)->left.empty() ? 1 : 0; }

/// Radiance pictures in the usual orientation. The header is read first, since stb knows no limit of bytes.
bool read_radiance(std::string_view contents, std::size_t most_bytes, ImageContents& image) {
  const stbi_io_callbacks calls{read_bytes, skip_bytes, is_at_end};
  Stream header{contents}, stream{contents};
  int channels = 0;
  if (stbi_info_from_callbacks(&calls, &header, &image.width, &image.height, &channels) == 0 ||
      channels != 3 || image.width <= 0 || image.height <= 0)
    return false;
  if (!start_image(channels, TexelType::kFloat, most_bytes, image)) return false;
  const std::unique_ptr<float, decltype(&stbi_image_free)> texels(
      stbi_loadf_from_callbacks(&calls, &stream, &image.width, &image.height, &channels, channels),
      stbi_image_free);
  if (!texels || stream.ended_early) return false;
  std::memcpy(image.bytes.data(), texels.get(), image.bytes.size());
  return true;
}

}  // namespace

std::optional<ImageContents> read_common_image(std::string_view contents, std::size_t most_bytes) {
  ImageContents image;
  try {
    if (contents.starts_with("\xff\xd8\xff") && read_jpeg(contents, most_bytes, image)) return image;
    if (contents.starts_with("\x89PNG\r\n\x1a\n") && read_png(contents, most_bytes, image)) return image;
    if (contents.starts_with("\x76\x2f\x31\x01") && read_exr(contents, most_bytes, image)) return image;
    if (contents.starts_with("#?") && read_radiance(contents, most_bytes, image)) return image;
  } catch (const std::exception&) {
    // TexelReader says what is wrong.
  }
  return std::nullopt;
}

}  // namespace penumbra
