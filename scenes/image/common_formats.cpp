#include "scenes/image/common_formats.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

// After stdio.h, which it needs.
#include <jpeglib.h>

#include "scenes/image/image_room.h"

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

bool start_image(int channels, TexelType type, std::size_t most_bytes, ImageContents& image) {
  image.channels = channel_names(channels);
  image.type = type;
  return make_room(image, most_bytes).has_value();
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

}  // namespace

std::optional<ImageContents> read_common_image(std::string_view contents, std::size_t most_bytes) {
  ImageContents image;
  try {
    if (contents.starts_with("\xff\xd8\xff") && read_jpeg(contents, most_bytes, image)) return image;
    if (contents.starts_with("\x89PNG\r\n\x1a\n") && read_png(contents, most_bytes, image)) return image;
  } catch (const std::exception&) {
    // TexelReader says what is wrong.
  }
  return std::nullopt;
}

}  // namespace penumbra
