#include "scheduler/image/image_reader.h"

#include <fmt/format.h>

#include "kernels/host/module.h"

namespace penumbra {

namespace {

Expected<const ImageReader*> image_reader() {
  static const Expected<const void*> reader =
      load_module("libpenumbra_image_reader.so", "penumbra_image_reader");
  if (!reader) return fail(fmt::format("cannot load what reads images: {}", reader.error().message));
  return static_cast<const ImageReader*>(*reader);
}

}  // namespace

Expected<Image> read_image(const std::filesystem::path& path) {
  const auto reader = image_reader();
  if (!reader) return std::unexpected(reader.error());
  return (*reader)->read(path);
}

Expected<Image> read_image_header(const std::filesystem::path& path) {
  const auto reader = image_reader();
  if (!reader) return std::unexpected(reader.error());
  return (*reader)->read_header(path);
}

}  // namespace penumbra
